// Deleting inputs in the page: its question has the list of what refers to them. The real daemon, in Chromium.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { PageSession } from './page_session.mjs';

let session, daemon, groom, sky, bake;

before(async () => {
    session = await PageSession.start();
    ({ daemon, groom, sky, bake } = session);
});
after(() => session?.stop());

const is_listed = async (kind, digest) => (await fetch(`${daemon.address}/v1/${kind}s/${digest}`)).status === 200;

/** Clicks Delete on the card, gives the answers to the questions in turn, and returns the questions. */
async function delete_card(page, digest, answers) {
    const questions = [];
    const answer = async dialog => {
        questions.push(dialog.message());
        await (answers[questions.length - 1] ? dialog.accept() : dialog.dismiss());
    };
    page.on('dialog', answer);
    await page.locator(`.card[data-id="${digest}"]`).getByRole('button', { name: /^Delete/ }).click();
    await page.waitForFunction(() => true);
    while (questions.length < answers.length) await new Promise(done => setTimeout(done, 20));
    page.off('dialog', answer);
    return questions;
}

// A hair model with a name, and its relative: an environment without one.
test('an input that is needed is deleted after a question that lists what needs it', async () => {
    await session.put_name('model', 'hero/groom', groom);
    for (const [kind, digest, name] of [
        ['model', groom, 'name model/hero/groom, version 1'],
        ['environment', sky, null],
    ]) {
        const refused = await fetch(`${daemon.address}/v1/${kind}s/${digest}`, { method: 'DELETE' });
        assert.equal(refused.status, 409);
        const { needed_by } = await refused.json();
        assert.deepEqual(needed_by.bakes, { count: 1, first: [{ id: bake, state: 'done' }] });
        await session.with_page(async page => {
            await page.goto(`${daemon.address}/#/${kind}s`);
            const [first, second] = await delete_card(page, digest, [true, false]);
            assert.match(first, /^Delete .* and its file\?$/);
            assert.ok(second.includes(`\nbake ${bake.slice(0, 12)} (done)\n`), second);
            if (name) assert.ok(second.includes(`\n${name}\n`), second);
            assert.ok(await is_listed(kind, digest)); // the answer was no
            await delete_card(page, digest, [true, true]);
            await page.locator(`.card[data-id="${digest}"]`).waitFor({ state: 'detached' });
            assert.equal(await is_listed(kind, digest), false);
        });
    }
    assert.equal((await daemon.json(`/v1/bakes/${bake}`)).state, 'done');
});

test('an input that nothing needs is deleted after one question', async () => {
    const other = await daemon.add('environment', `${session.sample}/studio.hdr`);
    await session.with_page(async page => {
        await page.goto(`${daemon.address}/#/environments`);
        await delete_card(page, other, [false]);
        assert.ok(await is_listed('environment', other));
        const questions = await delete_card(page, other, [true]);
        await page.locator(`.card[data-id="${other}"]`).waitFor({ state: 'detached' });
        assert.equal(questions.length, 1);
    });
});
