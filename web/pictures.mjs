// Takes the documentation's pictures of pages, all or some: node web/pictures.mjs FOLDER [NAME...]

import { mkdirSync, statSync } from "node:fs";
import { join } from "node:path";

import { begun, open, serve, until, visit } from "./tests/site.mjs";

const [folder, ...wanted] = process.argv.slice(2);
/** What fits beside text. */
const LARGEST = 150_000;
const PHONE = { width: 360, height: 640, hasTouch: true, isMobile: true };
const WINDOW = { width: 800, height: 640 };

/** The pages, the size of the window, and what to wait for. */
const PAGES = {
  index: ["index.html", WINDOW, async () => {}],
  own: ["own.html", WINDOW, touching],
  lint: ["lint.html", { width: 800, height: 860 }, linted],
  face_phone: ["face.html", PHONE, touching],
};

async function touching(page) {
  await begun(page);
  await until(page, () => window.show.state().red > 0);
  await page.keyboard.press("Space");
}

async function linted(page) {
  await until(page, () => window.lint.finished > 0);
  await until(page, () => document.querySelector(".lint iframe").offsetHeight > 1000);
}

mkdirSync(folder, { recursive: true });
const site = await serve();
const browser = await open();
try {
  for (const [name, [path, viewport, ready]] of Object.entries(PAGES)) {
    if (wanted.length > 0 && !wanted.includes(name)) continue;
    const { page } = await visit(browser.browser, `${site.origin}/${path}`, viewport);
    await ready(page);
    const picture = join(folder, `${name}.png`);
    await page.screenshot({ path: picture });
    const { size } = statSync(picture);
    console.log(`${picture}: ${size} bytes`);
    if (size > LARGEST) throw new Error(`${picture} is larger than ${LARGEST} bytes`);
    await page.close();
  }
} finally {
  await browser.close();
  site.close();
}
