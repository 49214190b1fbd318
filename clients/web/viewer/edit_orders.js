// The bakes that were ordered with an edited lighting. The maps of such a bake hold the edit, so the viewer must not
// apply it to them once more.
import { no_edit } from './lighting_edit.js';

export class EditOrders {
    /** Number of the current edit. Moving a slider changes the same edit; a new one begins with begin_edit(). */
    edit_number = 0;
    #orders = new Map(); // id of the ordered bake -> { edit_number, from: id of the bake that was edited }

    add(id, edit_number, from) {
        this.#orders.set(id, { edit_number, from });
    }

    begin_edit() {
        ++this.edit_number;
    }

    /**
     * Whether the edit is in the maps of bake `id`. left: id of the bake on the left when two are shown, else null. True
     * while the edit of the order is the current one; with the edited bake on the left also after that.
     */
    holds_edit(id, left = null) {
        const order = this.#orders.get(id);
        return Boolean(order) && (order.edit_number === this.edit_number || (left !== null && order.from === left));
    }
}

/**
 * How one or two bakes are shown at first: { sides, edit }. side: the settings of the left side so far; edit: so far.
 * One bake whose maps hold the edit begins a new edit: changes made after the order start from the old lighting, so
 * they are dropped. Beside the bake that was edited, the edit stays, as an edit of that bake.
 */
export function arrange(bakes, side, edit, orders) {
    if (bakes.length > 1) {
        const [{ id: left }] = bakes;
        const sides = bakes.map((bake, i) => ({ ...side, bake: i, as_baked: orders.holds_edit(bake.id, left) }));
        return { sides, edit };
    }
    const begins_new_edit = orders.holds_edit(bakes[0].id);
    if (begins_new_edit) orders.begin_edit();
    return { sides: [{ ...side, bake: 0, as_baked: false }], edit: begins_new_edit ? no_edit() : edit };
}
