// The determinism test in a browser: answers have the same bits as on every other machine. In Firefox, too, if there is one.

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { after, before, test } from "node:test";

import { FIREFOX, keep, open, serve, until, visit } from "./site.mjs";

let site;

before(async () => {
  site = await serve();
});

after(() => site.close());

async function answers(firefox) {
  const { browser, close } = await open({ drawing: false, firefox });
  try {
    const { page, errors } = await visit(browser, `${site.origin}/answers.html`);
    await until(page, () => window.answers?.done || window.answers?.trouble);
    const answers = await page.evaluate(() => window.answers);
    assert.equal(answers.trouble, null);
    assert.deepEqual(answers.differences, []);
    assert.ok(answers.scenes > 20, `${answers.scenes} scenes`);
    console.log(`${await browser.version()}: ${answers.scenes} scenes`);
    await keep(page, firefox ? "answers_firefox" : "answers");
    assert.deepEqual(errors, []);
  } finally {
    await close();
  }
}

test("answers are the same bits in Chromium", () => answers(false));

test("answers are the same bits in Firefox", { skip: existsSync(FIREFOX) ? false : `there is no ${FIREFOX}` }, () => answers(true));
