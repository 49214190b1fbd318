// The router: the part of the address after '#' and the page that it names.

/** "#/bake?model=x" -> { path: ['bake'], query: { model: 'x' } } */
export function read_route(hash) {
    const [path, query = ''] = hash.replace(/^#\/?/, '').split('?');
    const decode = text => {
        try {
            return decodeURIComponent(text);
        } catch {
            return text; // a broken escape stays as it is
        }
    };
    return {
        path: path.split('/').filter(Boolean).map(decode),
        query: Object.fromEntries(new URLSearchParams(query)),
    };
}

// Each page is a module, which is loaded when the page is first shown.
const pages = {
    environments: { load: () => import('./pages/environments_page.js'), title: () => 'Environments' },
    models: { load: () => import('./pages/models_page.js'), title: () => 'Hair models' },
    meshes: { load: () => import('./pages/meshes_page.js'), title: () => 'Meshes' },
    names: { load: () => import('./pages/name_page.js'), title: path => path.slice(2).join('/') || 'Names' },
    bake: { load: () => import('./pages/bake_page.js'), title: () => 'New bake' },
    bakes: {
        load: path => (path[1] ? import('./pages/one_bake_page.js') : import('./pages/bakes_page.js')),
        title: path => (path[1] ? `Bake ${path[1].slice(0, 10)}` : 'Bakes'),
    },
    rebake: { load: () => import('./pages/rebake_page.js'), title: () => 'Re-bake' },
    batches: { load: () => import('./pages/batch_page.js'), title: () => 'Batch' },
    view: { load: () => import('./pages/view_page.js'), title: () => 'Viewer' },
};

/** { load, title } of a path; null when there is no such page. */
export function page_of(path) {
    const name = path[0] ?? 'environments';
    if (!Object.hasOwn(pages, name)) return null;
    return { load: () => pages[name].load(path), title: pages[name].title(path) };
}
