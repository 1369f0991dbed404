// Lint in the browser: it reports where the sample runs into itself, refuses bad files with a reason, and nothing leaves the browser.

import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, truncateSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";

import { drop, keep, open, serve, until, visit } from "./site.mjs";

let site;
let browser;
let folder;

before(async () => {
  site = await serve();
  browser = await open({ drawing: false });
  folder = mkdtempSync(join(tmpdir(), "morph-collision-lint-"));
});

after(async () => {
  await browser.close();
  site.close();
  rmSync(folder, { recursive: true, force: true });
});

const what = (page) => page.$eval(".lint .what", (element) => element.textContent);
const finished = (page, times) => until(page, (times) => window.lint?.trouble || window.lint?.finished >= times, times);

/** The page with the report of its sample. */
async function lint(viewport) {
  const { page, errors } = await visit(browser.browser, `${site.origin}/lint.html`, viewport);
  await finished(page, 1);
  assert.equal(await page.evaluate(() => window.lint.trouble), null);
  const requests = [];
  page.on("request", (request) => requests.push(request.url()));
  return { page, errors, requests };
}

/** What is in the report. */
async function report(page) {
  await until(page, () => document.querySelector(".lint iframe").contentDocument?.querySelector("h1"));
  return page.$eval(".lint iframe", (frame) => {
    const { contentDocument: page } = frame;
    return {
      title: page.querySelector("h1").textContent,
      text: page.body.textContent,
      rows: page.querySelectorAll("tbody tr").length,
      pictures: page.querySelectorAll("svg").length,
      red: page.querySelectorAll("svg .t").length,
      isWhole: frame.offsetHeight >= page.documentElement.offsetHeight,
    };
  });
}

function file(name, bytes) {
  const path = join(folder, name);
  writeFileSync(path, bytes);
  return path;
}

test("the sample is linted: findings with pictures, in a page that can be saved", async () => {
  const { page, errors } = await lint();
  assert.match(await what(page), /^mh_head_eyes_teeth_arkit52\.glb: 133 findings in 308 shapes, after [\d.]+ s$/);
  console.log(await what(page));
  const { title, text, rows, pictures, red, isWhole } = await report(page);
  assert.equal(title, "Lint of mh_head_eyes_teeth_arkit52.glb");
  assert.match(text, /target mouthClose/);
  assert.deepEqual([rows, pictures], [133, 60]);
  assert.ok(red > 60, `${red} red triangles`);
  assert.ok(isWhole, "the report has a scroll bar of its own");
  const saved = await page.$eval(".lint .save", async (link) => [link.download, await (await fetch(link.href)).text()]);
  assert.equal(saved[0], "mh_head_eyes_teeth_arkit52.glb.lint.html");
  assert.match(saved[1], /^<!doctype html>/);
  await keep(page, "lint");
  assert.deepEqual(errors, []);
  await page.close();
});

test("the options of the form are those of the command", async () => {
  const { page, errors } = await lint();
  await drop(page, resolve("assets/mh_character_low.glb"), ".lint");
  await finished(page, 2);
  // Without the options, and with two of them. It is skinned, so there is no proof.
  assert.match(await what(page), /^mh_character_low\.glb: 36 findings in 582 shapes/);
  const without = await report(page);
  assert.doesNotMatch(without.text, /it clips at/);
  for (const name of ["suggest", "prove"]) await page.click(`.lint input[name=${name}]`);
  await page.click(".lint button[type=submit]");
  await finished(page, 3);
  assert.match(await page.$eval(".lint .warnings", (list) => list.textContent), /is skinned, so nothing is proved/);
  await until(page, () => /it clips at/.test(document.querySelector(".lint iframe").contentDocument.body.textContent));
  assert.deepEqual(errors, []);
  await page.close();
});

test("a bad file is refused with a reason, and another one can follow", async () => {
  const { page, errors, requests } = await lint();
  const head = readFileSync("assets/mh_head_eyes_teeth_arkit52.glb");
  const reasons = [];
  const refused = async (path) => {
    await drop(page, path, ".lint");
    const name = path.split("/").at(-1);
    await until(page, (name) => window.lint.trouble?.startsWith(name), name);
    assert.equal(await page.$eval(".lint .what", (element) => element.className), "what trouble");
    assert.ok(await page.$eval(".lint iframe", (frame) => frame.hidden), "the report of another file stays");
    const warnings = await page.$eval(".lint .warnings", (list) => list.textContent);
    reasons.push(`${await what(page)} ${warnings}`);
  };
  await refused(file("text.glb", "this is no model"));
  await refused(file("empty.glb", ""));
  await refused(file("short.glb", head.subarray(0, head.length / 2)));
  await refused(file("buffers.gltf", JSON.stringify({
    asset: { version: "2.0" },
    buffers: [{ uri: "elsewhere.bin", byteLength: 36 }],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3" }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
  })));
  // Claims more memory than there is: a sparse accessor of zeros takes no bytes in the file.
  await refused(file("claims.gltf", JSON.stringify({
    asset: { version: "2.0" },
    accessors: [{ componentType: 5126, count: 399_999_999, type: "VEC3", min: [0, 0, 0], max: [0, 0, 0] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
  })));
  truncateSync(file("large.glb", ""), 300e6);
  await drop(page, join(folder, "large.glb"), ".lint");
  await until(page, () => window.lint.trouble?.startsWith("large.glb"));
  assert.match(await what(page), /300 MB.*256 MB/);
  console.log(reasons.join("\n"));
  assert.match(reasons[0], /not a glTF 2\.0 file/);
  assert.match(reasons[3], /elsewhere\.bin/);
  assert.match(reasons[4], /memory.*morph-collide/);
  assert.match(await page.$eval(".lint .what", (element) => element.textContent), /large\.glb/);
  await keep(page, "lint_refused");

  await drop(page, resolve("assets/dolphin_564.glb"), ".lint");
  await finished(page, 2);
  assert.match(await what(page), /^dolphin_564\.glb: /);
  // The worker and its program are the only things that were asked for since the sample.
  const others = requests.filter((url) => !/\/(lint_worker\.js|checks\.js|checks_bg\.wasm)$|^(data|blob|about):/.test(url));
  assert.deepEqual(others, []);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a run can be stopped, and the page stays responsive meanwhile", async () => {
  const { page, errors } = await lint();
  await page.click(".lint input[name=pairs]");
  await page.click(".lint button[type=submit]");
  await until(page, () => /^pair of targets \d+ of 5304$/.test(document.querySelector(".lint .what").textContent));
  // Frames go on while the worker works.
  const gap = await page.evaluate(async () => {
    let [longest, last] = [0, performance.now()];
    for (let frame = 0; frame < 30; frame += 1) {
      const time = await new Promise((then) => setTimeout(() => then(performance.now()), 10));
      longest = Math.max(longest, time - last);
      last = time;
    }
    return longest;
  });
  assert.ok(gap < 1000, `nothing happened for ${gap} ms`);
  await page.click(".lint .stop");
  assert.equal(await what(page), "Stopped");
  await new Promise((then) => setTimeout(then, 500));
  assert.equal(await what(page), "Stopped");
  assert.deepEqual(errors, []);
  await page.close();
});

test("it fits on a phone", async () => {
  const { page, errors } = await lint({ width: 360, height: 740, hasTouch: true, isMobile: true });
  await report(page);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
  const inside = await page.$eval(".lint iframe", (frame) => [frame.contentDocument.documentElement.scrollWidth, frame.clientWidth]);
  assert.ok(inside[0] <= inside[1], `${inside}`);
  await page.screenshot({ path: join(process.env.PICTURES ?? "target/web-pictures", "lint_phone.png") });
  assert.deepEqual(errors, []);
  await page.close();
});
