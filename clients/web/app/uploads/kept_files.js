// Files whose sending has not ended, in IndexedDB, so that a reload goes on with them. Where that is not possible (no
// room, a private window), the same file picked again goes on as well.

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
