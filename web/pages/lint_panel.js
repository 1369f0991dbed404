// Options, progress and the report of lint. The work is done in a worker, so the page stays responsive.

import { lacking } from "./load.js";

const OPTIONS = [
  ["pairs", "pairs of targets", "Also tries all pairs of targets, each at 0.5 and 1. Takes long if there are many targets."],
  ["suggest", "limits for sliders", "Finds the largest weight of each target that does not clip."],
  ["prove", "proof for all weights", "Also proves which pairs of triangles never touch for any weights from 0 to 1. Not for skinned meshes."],
];

export class Panel {
  /** The file that was brought last. */
  #file = null;
  #worker = null;
  #saved = null;
  /** What a test may ask: the number of reports that are finished, and why there is none. */
  finished = 0;
  trouble = null;

  constructor(element) {
    element.innerHTML = `
      <form>
        <fieldset><legend>Also look for</legend>
          ${OPTIONS.map(([name, words, help]) => `<label title="${help}"><input type="checkbox" name="${name}"> ${words}</label>`).join("")}
        </fieldset>
        <button type="submit" disabled>Run again</button>
        <button type="button" class="stop" hidden>Stop</button>
        <a class="save" hidden>Save the report</a>
      </form>
      <p class="what" role="status" aria-live="polite">No file yet</p>
      <progress hidden></progress>
      <ul class="warnings" hidden></ul>
      <iframe title="The report" hidden></iframe>`;
    const find = (name) => element.querySelector(name);
    [this.form, this.again, this.stop, this.save] = ["form", "button[type=submit]", ".stop", ".save"].map(find);
    [this.what, this.bar, this.warnings, this.report] = [".what", "progress", ".warnings", "iframe"].map(find);
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#run();
    });
    this.stop.addEventListener("click", () => {
      this.#end();
      this.what.textContent = "Stopped";
    });
    this.report.addEventListener("load", () => this.#fit());
  }

  /** Lints a file. */
  bring(name, bytes) {
    this.#file = { name, bytes };
    this.#run();
  }

  /** Says why a file cannot be linted. */
  refuse(why) {
    this.#file = null;
    this.warnings.replaceChildren();
    this.report.hidden = this.save.hidden = this.warnings.hidden = true;
    this.#fail(why);
  }

  /** Says why there is no report. */
  #fail(why) {
    this.#end();
    this.trouble = why;
    this.what.textContent = why;
    this.what.className = "what trouble";
  }

  #run() {
    const { name, bytes } = this.#file;
    const lack = lacking({ drawing: false });
    if (lack) return this.#fail(lack);
    this.#end();
    this.trouble = null;
    this.what.className = "what";
    this.what.textContent = `Looking into ${name}`;
    this.warnings.replaceChildren();
    this.warnings.hidden = this.report.hidden = this.save.hidden = true;
    this.stop.hidden = this.bar.hidden = false;
    this.bar.removeAttribute("value");
    this.again.disabled = true;

    // A new one every time: after a long run, its memory would stay as large as it has become.
    this.#worker = new Worker("lint_worker.js", { type: "module" });
    this.#worker.addEventListener("message", ({ data }) => this.#hear(data));
    this.#worker.addEventListener("error", (event) => {
      event.preventDefault();
      this.#fail(`The program cannot run: ${event.message ?? "its files cannot be loaded"}. Reload the page to try again.`);
    });
    const options = OPTIONS.map(([option]) => this.form.elements[option].checked);
    this.#worker.postMessage({ name, bytes, options });
  }

  #hear({ progress, warning, error, report }) {
    if (progress) {
      const { what, done, all } = progress;
      this.what.textContent = all ? `${what} ${done} of ${all}` : what;
      if (all) {
        this.bar.max = all;
        this.bar.value = done;
      } else {
        this.bar.removeAttribute("value");
      }
    }
    if (warning) {
      const line = document.createElement("li");
      line.textContent = explained(warning);
      this.warnings.append(line);
      this.warnings.hidden = false;
    }
    if (error) this.#fail(explained(error));
    if (report) this.#show(report);
  }

  #show({ html, findings, shapes, seconds }) {
    this.#end();
    this.what.textContent = `${this.#file.name}: ${count(findings, "finding")} in ${count(shapes, "shape")}, after ${seconds.toFixed(1)} s`;
    this.report.srcdoc = html;
    this.report.hidden = false;
    if (this.#saved) URL.revokeObjectURL(this.#saved);
    this.#saved = URL.createObjectURL(new Blob([html], { type: "text/html" }));
    this.save.href = this.#saved;
    this.save.download = `${this.#file.name}.lint.html`;
    this.save.hidden = false;
    this.finished += 1;
  }

  /** The report is as high as what is in it, so that only the page scrolls. */
  #fit() {
    const page = this.report.contentDocument?.documentElement;
    if (!page) return;
    const fit = () => { this.report.style.height = `${page.offsetHeight + 40}px`; };
    new ResizeObserver(fit).observe(page);
    fit();
  }

  #end() {
    this.#worker?.terminate();
    this.#worker = null;
    this.stop.hidden = this.bar.hidden = true;
    this.again.disabled = !this.#file;
  }
}

/** A message of lint, which may name an option that the page does not have. */
function explained(message) {
  return message.includes("--memory-limit") ? `${message}. That is an option of the program morph-collide; this page has no more memory.` : message;
}

const count = (number, noun) => `${number.toLocaleString("en")} ${noun}${number === 1 ? "" : "s"}`;
