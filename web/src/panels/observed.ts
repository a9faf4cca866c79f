// What was observed in the field beside what the runs on display have computed.
import type { ScenarioName } from "../protocol/frame";
import type { ObservedRow } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { number, unitText } from "../state/format";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

const sign: Readonly<Record<ObservedRow["is"], string>> = { equal: "", at_least: "at least ", below: "below " };

export class ObservedTable {
  readonly element = h("div", { class: "observed-beside", hidden: true });
  private readonly rows = new Map<ScenarioName, readonly ObservedRow[]>();
  private busy = false;

  constructor(private readonly twin: Twin) {
    watchAll([twin.shown], () => this.draw());
    // An observation that is added or changed is there at once.
    let before = "";
    watchAll(twin.every("setup"), () => {
      const now = twin.shown.value.map((name) => JSON.stringify(twin.cells[name].setup.value?.observations ?? [])).join();
      if (now !== before) void this.refresh();
      before = now;
    });
  }
  of(name: ScenarioName): readonly ObservedRow[] {
    return this.rows.get(name) ?? [];
  }
  async refresh(): Promise<void> {
    const { twin } = this;
    const names = twin.shown.value.filter((name) => twin.cells[name].setup.value !== null);
    if (this.busy || names.length === 0 || twin.connection.value.state !== "open") return;
    this.busy = true;
    await twin.attempt(async () => {
      for (const name of names) this.rows.set(name, (await twin.api.observed(name)).rows);
    });
    this.busy = false;
    this.draw();
  }
  private draw(): void {
    const names = this.twin.shown.value;
    const first = this.of(names[0]);
    const all = [...first, ...names.slice(1).flatMap((name) => this.of(name).filter((r) => !first.some((f) => f.name === r.name)))];
    this.element.hidden = all.length === 0;
    this.element.replaceChildren(h("h3", {}, "Observed and computed"), h("table", { class: "plain observed" },
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Observation"), h("td", {}, "Observed"), ...names.map((name) => h("td", {}, names.length > 1 ? `Computed ${name}` : "Computed")))),
      h("tbody", {}, ...all.map((row) => h("tr", {}, h("th", { scope: "row" }, row.name, row.unit ? h("small", {}, ` ${unitText(row.unit)}`) : null),
        h("td", {}, `${sign[row.is]}${number(row.observed)} ± ${number(row.uncertainty, 2)}`),
        ...names.map((name) => {
          const own = this.of(name).find((r) => r.name === row.name);
          const off = own?.deviation ?? null;
          return h("td", { title: off === null ? "" : `${number(Math.abs(off), 2)} standard deviations off`, class: off !== null && Math.abs(off) > 2 ? "far" : "" }, number(own?.computed));
        }))))));
  }
}
