// Every page in a browser: it loads, draws what morphs, and finds what touches.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { begun, drawn, frames, keep, open, pace, serve, state, until, visit } from "./site.mjs";

let site;
let browser;
const paces = {};

before(async () => {
  site = await serve();
  browser = await open();
});

after(async () => {
  for (const [name, { rate, script }] of Object.entries(paces)) console.log(`${name}: ${rate} frames per second, ${script?.toFixed(1)} ms of each in the program`);
  await browser.close();
  site.close();
});

/** Until this much of the show's state is so. */
const shows = (page, condition) => until(page, `(${condition})(window.show.state())`);
const note = (name) => `Number.parseFloat(state.notes.find(([name]) => name === ${JSON.stringify(name)})?.[1] ?? "")`;

/** The key that pauses. */
const pauseKey = (name) => (name === "physics" ? "p" : "Space");

/** What every show has to find, as a condition on its state. */
const FOUND = {
  dolphins: "(state) => state.triangle_pairs > 0 && state.red > 0 && state.events > 0",
  pass_through: "(state) => state.triangle_pairs > 0 && state.red > 0 && state.events > 0",
  crowd: "(state) => state.triangle_pairs > 0 && state.red > 0 && state.events > 0",
  face: `(state) => ${note("self-intersections")} > 0 && state.red > 0`,
  character: `(state) => ${note("parts near crates")} > 0 && ${note("hand on face")} >= 0`,
  slap: `(state) => ${note("felt, left")} === 0 && ${note("felt, right")} > 0`,
  dust: `(state) => ${note("on the skin")} > 20`,
  picking: `(state) => ${note("triangle")} >= 0`,
  culling: `(state) => ${note("drawn, left")} < ${note("drawn, right")}`,
  physics: `(state) => ${note("parts of surfaces near")} > 0`,
  own: "(state) => state.triangle_pairs > 0 && state.red > 0 && state.events > 0",
};

for (const [name, found] of Object.entries(FOUND)) {
  test(`${name} draws a model that morphs, and finds what it should`, async () => {
    const { page, errors } = await visit(browser.browser, `${site.origin}/${name}.html`);
    await begun(page);
    const box = await (await page.$("#show")).boundingBox();
    if (name === "picking") await page.mouse.move(box.x + 0.55 * box.width, box.y + 0.5 * box.height);
    await shows(page, found);

    // Weights change, and so does the picture.
    await until(page, () => window.show.state().weights.length > 0);
    const first = { picture: await drawn(page), state: await state(page) };
    await until(page, (before) => window.show.state().weights.some((weight, i) => weight !== before[i]), first.state.weights);
    const second = { picture: await drawn(page), state: await state(page) };
    assert.ok(second.state.frame > first.state.frame);
    assert.ok(!first.picture.equals(second.picture), "nothing moves on the canvas");
    await keep(page, name);

    // Paused, both stand still: it was the show that changed the picture.
    await page.keyboard.press(pauseKey(name));
    await frames(page);
    const third = { picture: await drawn(page), state: await state(page) };
    const fourth = { picture: await drawn(page), state: await state(page) };
    assert.equal(fourth.state.frame, third.state.frame);
    assert.ok(fourth.picture.equals(third.picture), "something moves while the show is paused");

    await page.keyboard.press(pauseKey(name));
    paces[name] = await pace(page);
    assert.deepEqual(errors, []);
    await page.close();
  });
}

test("keys make the player walk and jump", async () => {
  const { page, errors } = await visit(browser.browser, `${site.origin}/physics.html`);
  await begun(page);
  const player = `window.show.state().notes.find(([name]) => name === "player")[1]`;
  await until(page, `${player} === "on the hill"`);
  await page.keyboard.press("Space");
  await until(page, `${player} === "in the air"`);
  await until(page, `${player} !== "in the air"`);
  // Straight ahead it leaves the hill, which it would not do by itself.
  await page.keyboard.down("w");
  await until(page, `${player} === "on the ground"`);
  await page.keyboard.up("w");
  assert.deepEqual(errors, []);
  await page.close();
});

test("buttons stand for keys", async () => {
  const { page, errors } = await visit(browser.browser, `${site.origin}/picking.html`);
  await begun(page);
  const frame = async () => (await state(page)).frame;
  await page.click("[data-code=Space]");
  assert.equal(await page.evaluate(() => document.activeElement.id), "show", "the canvas loses the focus, and with it every key that is held");
  await frames(page);
  const paused = await frame();
  await frames(page, 2);
  assert.equal(await frame(), paused);
  await page.click("[data-code=Period]");
  await until(page, (paused) => window.show.state().frame === paused + 1, paused);
  // Boxes, a level down and up again.
  for (const [code, level] of [["KeyV", 0], ["KeyV", 1], ["ShiftLeft KeyV", 0], ["ShiftLeft KeyV", null]]) {
    await page.click(`[data-code="${code}"]`, { delay: 50 });
    await until(page, (level) => window.show.state().volumes === level, level);
  }
  // And with the keyboard, when the button has the focus.
  await page.focus("[data-code=Space]");
  await page.keyboard.press("Enter");
  await until(page, (paused) => window.show.state().frame > paused + 2, paused);
  assert.deepEqual(errors, []);
  await page.close();
});

test("weights can be set by hand, and given back", async () => {
  const { page, errors } = await visit(browser.browser, `${site.origin}/face.html`);
  await begun(page);
  await page.click(".weights summary");
  await page.click(".weights input[type=checkbox]");
  const jaw = (await state(page)).targets.indexOf("jawOpen");
  // The slider of a target, as a screen reader finds it.
  const slider = await page.$(`aria/jawOpen[role="slider"]`);
  await slider.focus();
  await page.keyboard.press("End");
  await until(page, (jaw) => window.show.state().weights[jaw] === 1.5, jaw);
  await frames(page);
  const held = (await state(page)).weights;
  assert.ok(held.some((weight, i) => weight !== 0 && i !== jaw), "the other weights are lost");
  await frames(page);
  assert.deepEqual((await state(page)).weights, held, "something else sets weights");
  await keep(page, "weights");
  await page.click(".weights input[type=checkbox]");
  await until(page, (jaw) => window.show.state().weights[jaw] < 1.5, jaw);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a finger looks around", async () => {
  const phone = { width: 420, height: 800, hasTouch: true, isMobile: true };
  const { page, errors } = await visit(browser.browser, `${site.origin}/picking.html`, phone);
  await begun(page);
  assert.equal(await page.evaluate(() => scrollY), 0, "the page scrolls by itself");
  await page.keyboard.press("Space");
  await frames(page);
  const box = await (await page.$("#show")).boundingBox();
  const still = await drawn(page);
  assert.ok(still.equals(await drawn(page)));
  const [x, y] = [box.x + 0.5 * box.width, box.y + 0.5 * box.height];
  await page.touchscreen.touchStart(x, y);
  await frames(page, 1);
  for (let step = 1; step <= 4; step += 1) {
    await page.touchscreen.touchMove(x + 20 * step, y);
    await frames(page, 1);
  }
  await page.touchscreen.touchEnd();
  await frames(page);
  assert.ok(!still.equals(await drawn(page)), "the camera stays where it is");
  await keep(page, "picking_phone");
  assert.deepEqual(errors, []);
  await page.close();
});

test("the gallery leads to every page, with pictures", async () => {
  const { page, errors } = await visit(browser.browser, `${site.origin}/index.html`);
  const { links } = await page.evaluate(() => ({
    links: [...document.querySelectorAll(".cards a")].map((link) => link.getAttribute("href")),
  }));
  const pictures = await page.evaluate(() => Promise.all([...document.images].map(async (picture) => {
    picture.loading = "eager";
    return [picture.src, await picture.decode().then(() => picture.naturalWidth > 0, () => false)];
  })));
  assert.deepEqual(links.toSorted(), [...Object.keys(FOUND), "answers", "lint"].map((name) => `${name}.html`).toSorted());
  for (const [source, is] of pictures) assert.ok(is, source);
  for (const link of links) {
    const response = await fetch(`${site.origin}/${link}`);
    assert.equal(response.status, 200, link);
  }
  await keep(page, "index");
  assert.deepEqual(errors, []);
  await page.close();
});

test("a browser that cannot draw is told so", async () => {
  const blind = await open({ drawing: false });
  try {
    const { page } = await visit(blind.browser, `${site.origin}/dolphins.html`);
    await until(page, () => window.show?.trouble);
    const text = await page.$eval("[role=alert]", (alert) => alert.textContent);
    assert.match(text, /WebGL 2/);
    await keep(page, "without_webgl");
  } finally {
    await blind.close();
  }
});

test("what cannot be downloaded is named", async () => {
  const page = await browser.browser.newPage();
  await page.setRequestInterception(true);
  page.on("request", (request) => (request.url().endsWith("dolphin_2256.glb") ? request.respond({ status: 404 }) : request.continue()));
  await page.goto(`${site.origin}/dolphins.html`);
  await until(page, () => window.show?.trouble);
  assert.match(await page.$eval("[role=alert]", (alert) => alert.textContent), /dolphin_2256\.glb: 404/);
  await page.close();
});
