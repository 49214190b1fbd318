// Files of unfinished uploads, kept in IndexedDB so that a reload resumes them. Where they cannot be kept (no room, a
// private window), picking the same file again resumes its upload too.

const store_name = 'files';

function open_database() {
    return new Promise((resolve, reject) => {
        const request = indexedDB.open('hairbake-uploads', 1);
        request.onupgradeneeded = () => request.result.createObjectStore(store_name, { keyPath: 'id' });
        request.onsuccess = () => resolve(request.result);
        request.onerror = () => reject(request.error);
    });
}

async function with_store(mode, act) {
    const database = await open_database();
    try {
        return await new Promise((resolve, reject) => {
            const transaction = database.transaction(store_name, mode);
            const request = act(transaction.objectStore(store_name));
            transaction.oncomplete = () => resolve(request.result);
            transaction.onerror = transaction.onabort = () => reject(transaction.error);
        });
    } finally {
        database.close();
    }
}

/** entry: { id, kind, file } */
export const keep_file = entry => with_store('readwrite', store => store.put(entry)).catch(() => {});
export const forget_file = id => with_store('readwrite', store => store.delete(id)).catch(() => {});
export const kept_files = () => with_store('readonly', store => store.getAll()).catch(() => []);
export const kept_file = id => with_store('readonly', store => store.get(id)).catch(() => undefined);
export const forget_files = () => with_store('readwrite', store => store.clear()).catch(() => {});
