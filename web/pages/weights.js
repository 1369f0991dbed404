// The weights of a show's models, and sliders to set them by hand.

export class Weights {
  /**
   * Adds the closed list of sliders to `parent`. `state()` is the show's state, or null before it begins; `give(weights)` gives all models these weights, or
   * their own if there are none.
   */
  constructor(parent, { state, give }) {
    parent.insertAdjacentHTML("beforeend", `
      <details class="weights" hidden>
        <summary>Weights</summary>
        <label><input type="checkbox"> Set them by hand, for all models</label>
        <div class="sliders"></div>
      </details>`);
    this.list = parent.querySelector(".weights");
    [this.hand, this.rows] = ["input", ".sliders"].map((name) => this.list.querySelector(name));
    [this.state, this.give] = [state, give];
    /** The weights that the models have, and the number of the frame from which on the state says whether they are set by hand. */
    [this.weights, this.from] = [[], 0];
    this.hand.addEventListener("change", () => {
      this.weights = this.state()?.weights ?? this.weights;
      this.write();
      this.send();
    });
    this.list.addEventListener("toggle", () => this.write());
    this.rows.addEventListener("input", ({ target }) => {
      // Only this one changes: others may have weights that no slider can show.
      this.weights[[...this.rows.children].indexOf(target.parentElement)] = Number(target.value);
      target.nextElementSibling.textContent = Number(target.value).toFixed(2);
      this.send();
    });
  }

  send() {
    // The frame that is under way may not have seen it.
    this.from = (this.state()?.drawn ?? 0) + 2;
    this.give(this.hand.checked ? new Float32Array(this.weights) : undefined);
  }

  /** Shows the show's state, unless the sliders are set by hand. */
  show({ targets, weights, in_hand, drawn }) {
    this.list.hidden = targets.length === 0;
    const names = JSON.stringify(targets);
    if (this.names !== names) {
      this.names = names;
      this.rows.replaceChildren(...targets.map(row));
    }
    if (drawn >= this.from) this.hand.checked = in_hand;
    if (this.hand.checked && this.weights.length === weights.length) return;
    this.weights = weights;
    this.write();
  }

  write() {
    if (!this.list.open) return;
    [...this.rows.children].forEach((row, i) => {
      const [, slider, value] = row.children;
      slider.disabled = !this.hand.checked;
      slider.value = this.weights[i] ?? 0;
      value.textContent = (this.weights[i] ?? 0).toFixed(2);
    });
  }
}

function row(target) {
  const [label, name, slider, value] = ["label", "span", "input", "span"].map((tag) => document.createElement(tag));
  name.textContent = target;
  Object.assign(slider, { type: "range", min: -0.5, max: 1.5, step: 0.01, value: 0, ariaLabel: target });
  label.append(name, slider, value);
  return label;
}
