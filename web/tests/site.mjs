// The site, served on this machine, and a browser that looks at it.

import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import puppeteer from "puppeteer-core";

/** Where `just web` puts the site. */
const SITE = process.env.SITE ?? "target/web-site";
/** Where pictures of the pages go, for people to look at. */
const PICTURES = process.env.PICTURES ?? "target/web-pictures";
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
export const FIREFOX = process.env.FIREFOX ?? "/usr/bin/firefox";
/** How many milliseconds a condition may take: software draws slowly, above all beside other work. */
const PATIENCE = 1000 * Number(process.env.PATIENCE ?? 240);

/** Nothing is drawn by a graphics card, and nothing is asked of the world outside. */
const FLAGS = [
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
const DRAWING = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const NOT_DRAWING = ["--disable-3d-apis"];

/** Serves the site on a port that is free; `origin`, and `close` to end it. */
export async function serve() {
  const server = spawn("python3", ["-u", "-m", "http.server", "0", "--bind", "127.0.0.1", "--directory", SITE], {
    stdio: ["ignore", "pipe", "ignore"],
  });
  const [line] = await once(server.stdout, "data");
  const port = /port (\d+)/.exec(line)[1];
  return { origin: `http://127.0.0.1:${port}`, close: () => server.kill() };
}

/** A browser with a profile of its own. */
export async function open({ drawing = true, firefox = false } = {}) {
  const profile = mkdtempSync(join(tmpdir(), "morph-collision-browser-"));
  const browser = await puppeteer.launch({
    browser: firefox ? "firefox" : "chrome",
    executablePath: firefox ? FIREFOX : CHROMIUM,
    args: firefox ? [] : [...FLAGS, ...(drawing ? DRAWING : NOT_DRAWING), "--window-size=1100,900"],
    defaultViewport: { width: 1000, height: 800 },
    userDataDir: profile,
    protocolTimeout: PATIENCE + 60_000,
  });
  const close = async () => {
    await browser.close();
    rmSync(profile, { recursive: true, force: true });
  };
  return { browser, close };
}

/** A page, and everything that went wrong on it. */
export async function visit(browser, url, viewport) {
  const page = await browser.newPage();
  if (viewport) await page.setViewport(viewport);
  const { origin } = new URL(url);
  const errors = [];
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) errors.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => errors.push(`uncaught: ${error.message}`));
  page.on("requestfailed", (request) => errors.push(`${request.url()}: ${request.failure()?.errorText}`));
  page.on("request", (request) => {
    const from = request.url();
    if (!from.startsWith(origin) && !/^(data|blob):/.test(from)) errors.push(`${from}: from outside`);
  });
  page.on("response", (response) => {
    if (response.status() >= 400) errors.push(`${response.url()}: ${response.status()}`);
  });
  // How long the program's part of each frame takes, without what the graphics do at the same time.
  await page.evaluateOnNewDocument(() => {
    window.scriptTimes = [];
    const request = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (frame) => request((time) => {
      const start = performance.now();
      frame(time);
      window.scriptTimes.push(performance.now() - start);
    });
  });
  await page.goto(url, { timeout: PATIENCE });
  return { page, errors };
}

/** Frames per second, and the median of the program's own milliseconds in a frame, over the next ten seconds. */
export async function pace(page) {
  const { drawn } = await state(page);
  await page.evaluate(() => { window.scriptTimes = []; });
  await new Promise((then) => setTimeout(then, 10_000));
  const times = (await page.evaluate(() => window.scriptTimes)).toSorted((a, b) => a - b);
  return { rate: ((await state(page)).drawn - drawn) / 10, script: times[times.length >> 1] };
}

/** Until a condition holds on the page, whose arguments follow it. */
export function until(page, condition, ...args) {
  return page.waitForFunction(condition, { timeout: PATIENCE, polling: 100 }, ...args);
}

/** Until its show runs. */
export async function begun(page) {
  await until(page, () => window.show && (window.show.trouble || window.show.state()?.started));
  const trouble = await page.evaluate(() => window.show.trouble);
  if (trouble) throw new Error(trouble);
  await until(page, () => document.querySelector(".cover").hidden);
}

export const state = (page) => page.evaluate(() => window.show.state());

/** Until the show has drawn some more frames, so that it has seen what was done before, however slowly it is drawn. */
export async function frames(page, count = 3) {
  const { drawn } = await state(page);
  await until(page, (goal) => window.show.state().drawn >= goal, drawn + count);
}

/** What is drawn. */
export async function drawn(page) {
  const clip = await (await page.$("#show")).boundingBox();
  return Buffer.from(await page.screenshot({ clip }));
}

/** A picture of the whole page, for people to look at. */
export async function keep(page, name) {
  mkdirSync(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, `${name}.png`), fullPage: true });
}

/** Drops a file from the disk on the stage or another part of the page, as a hand would. */
export async function drop(page, path, on = ".stage") {
  const box = await (await page.$(on)).boundingBox();
  const client = await page.createCDPSession();
  const data = { items: [], files: [path], dragOperationsMask: 1 };
  for (const type of ["dragEnter", "dragOver", "drop"]) {
    await client.send("Input.dispatchDragEvent", { type, x: box.x + box.width / 2, y: box.y + Math.min(box.height / 2, 200), data });
  }
  await client.detach();
}
