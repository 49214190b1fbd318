// Lists of the service, which come in pages.

/** Most items that a list of the page shows: drawing more is slow. */
export const most_shown = 1000;

// The largest page that the service sends, by the list's key in the answer.
const page_sizes = { bakes: 1000, names: 1000, models: 200, environments: 200 };

/**
 * Fetches the pages of a list until it ends or most_shown items are there.
 * path: address of the list; key: the answer's field that holds the items.
 * Returns { items, more }; more: whether the service has more items.
 */
export async function all_pages(api, path, key) {
    const items = [];
    const limit = page_sizes[key];
    for (let cursor = '';;) {
        const page = await api.json(path + (path.includes('?') ? '&' : '?') + `limit=${limit}${cursor}`);
        items.push(...page[key]);
        if (!page.next || items.length >= most_shown) return { items, more: Boolean(page.next) };
        cursor = `&cursor=${encodeURIComponent(page.next)}`;
    }
}
