// One's own model: good files are shown, bad ones are refused with a reason, and nothing leaves the browser.

import assert from "node:assert/strict";
import { copyFileSync, mkdtempSync, readFileSync, rmSync, truncateSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";

import { begun, drop, keep, open, serve, until, visit } from "./site.mjs";

let site;
let browser;
let folder;

before(async () => {
  site = await serve();
  browser = await open();
  folder = mkdtempSync(join(tmpdir(), "morph-collision-own-"));
});

after(async () => {
  await browser.close();
  site.close();
  rmSync(folder, { recursive: true, force: true });
});

const message = (page) => page.$eval(".message", (element) => element.textContent);
const report = (page) => page.$eval("pre", (element) => element.textContent);

/** The page with its first model. */
async function own() {
  const { page, errors } = await visit(browser.browser, `${site.origin}/own.html`);
  const requests = [];
  await begun(page);
  await until(page, () => document.querySelector("pre").textContent.includes("dolphin_2256.glb"));
  // From here on nothing may be asked of anyone.
  page.on("request", (request) => requests.push(request.url()));
  return { page, errors, requests };
}

/** A file with this in it. */
function file(name, bytes) {
  const path = join(folder, name);
  writeFileSync(path, bytes);
  return path;
}

/** Drops a file that has to be refused, and is the reason. */
async function refused(page, path) {
  await drop(page, path);
  await until(page, (name) => {
    const { className, textContent } = document.querySelector(".message");
    return className.includes("trouble") && textContent.startsWith(name);
  }, path.split("/").at(-1));
  return message(page);
}

test("a model that is dropped is inspected, played, and collides with its copy", async () => {
  const { page, errors, requests } = await own();
  const head = join(folder, "my head.glb");
  copyFileSync("assets/mh_head_eyes_teeth_arkit52.glb", head);
  await drop(page, head);
  await until(page, () => document.querySelector("pre").textContent.includes("my head.glb"));
  assert.equal(await message(page), "my head.glb");
  assert.match(await report(page), /targets +52[\s\S]*jawOpen/);

  // Both copies are there, morph, and touch, in red.
  await until(page, () => {
    const state = window.show.state();
    return state.weights.length === 52 && state.colliders === 2 && state.triangle_pairs > 0 && state.red > 0;
  });
  const { weights } = await page.evaluate(() => window.show.state());
  await until(page, (before) => window.show.state().weights.some((weight, i) => weight !== before[i]), weights);

  // It is timed beside a refit of the whole mesh, which blends every vertex of both; this does not.
  await until(page, () => window.show.state().notes.length >= 2);
  const notes = Object.fromEntries((await page.evaluate(() => window.show.state())).notes);
  const vertices = (line) => Number(/([\d.]+) vertices/.exec(line)[1]);
  assert.ok(vertices(notes["morph trees"]) < vertices(notes["whole mesh refitted"]), JSON.stringify(notes));
  console.log("the head:", JSON.stringify(notes));
  await keep(page, "own_head");
  assert.deepEqual(requests, [], "something was asked of someone");
  assert.deepEqual(errors, []);
  await page.close();
});

test("the other tab lints the same model", async () => {
  const { page, errors } = await own();
  await page.click("[data-tab=lint]");
  await until(page, () => /^dolphin_2256\.glb: .* shapes, after/.test(document.querySelector(".lint .what")?.textContent));
  assert.ok(await page.$eval("main", (show) => show.hidden));
  // Another one is linted at once.
  await drop(page, resolve("assets/mh_character_low.glb"), ".lint");
  await until(page, () => /^mh_character_low\.glb: 36 findings/.test(document.querySelector(".lint .what").textContent));
  await keep(page, "own_lint");
  // And collides with its copy, on the first tab.
  await page.click("[data-tab=collide]");
  await until(page, () => document.querySelector("pre").textContent.includes("mh_character_low.glb"));
  assert.ok(await page.$eval("section.lint", (panel) => panel.hidden));
  assert.deepEqual(errors, []);
  await page.close();
});

test("a file that is no good is refused, and the model before it stays", async () => {
  const { page, errors, requests } = await own();
  const dolphin = readFileSync("assets/dolphin_564.glb");
  const before = await report(page);
  const reasons = [];

  reasons.push(await refused(page, file("text.glb", "this is no model")));
  reasons.push(await refused(page, file("empty.glb", "")));
  reasons.push(await refused(page, file("short.glb", dolphin.subarray(0, dolphin.length / 2))));
  reasons.push(await refused(page, file("buffers.gltf", JSON.stringify({
    asset: { version: "2.0" },
    buffers: [{ uri: "elsewhere.bin", byteLength: 36 }],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3" }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
  }))));
  reasons.push(await refused(page, rigid("rigid.glb")));
  truncateSync(file("large.glb", ""), 300e6);
  const large = await refused(page, join(folder, "large.glb"));
  assert.match(large, /300 MB.*256 MB/);
  console.log(reasons.join("\n"));
  assert.match(reasons[3], /elsewhere\.bin/);
  assert.match(reasons[4], /morph targets/);
  for (const reason of reasons) assert.match(reason, /The model before it stays\.$/);
  await keep(page, "own_refused");

  // It still plays, and another good one takes its place.
  assert.equal(await report(page), before);
  const { frame } = await page.evaluate(() => window.show.state());
  await until(page, (frame) => window.show.state().frame > frame && window.show.state().colliders === 2, frame);
  await drop(page, resolve("assets/dolphin_564.glb"));
  await until(page, () => document.querySelector("pre").textContent.includes("dolphin_564.glb"));
  assert.deepEqual(requests, []);
  assert.deepEqual(errors, []);
  await page.close();
});

/** A triangle that does not morph. */
function rigid(name) {
  const positions = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer);
  return file(name, JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] }],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    buffers: [{ uri: `data:application/octet-stream;base64,${positions.toString("base64")}`, byteLength: 36 }],
  }));
}

for (const name of ["AnimatedMorphCube.gltf", "ict_face_skin.glb", "mh_body_arkit52.glb", "Fox.glb"]) {
  const path = resolve("../shared/models", name);
  test(`${name} is shown, or refused with a reason`, { skip: exists(path) ? false : `${path} is not here` }, async () => {
    const { page, errors } = await own();
    await drop(page, path);
    await until(page, (name) => {
      const model = window.show.state()?.model;
      return window.show.trouble || (model?.name === name && (model.shown || model.error));
    }, name);
    assert.equal(await page.evaluate(() => window.show.trouble), null);
    const { model } = await page.evaluate(() => window.show.state());
    console.log(name, model.error ?? "shown");
    if (model.shown) await until(page, () => window.show.state().triangle_pairs > 0);
    await keep(page, `own_${name}`);
    assert.deepEqual(errors, []);
    await page.close();
  });
}

function exists(path) {
  try {
    readFileSync(path);
    return true;
  } catch {
    return false;
  }
}
