// What was observed in the field beside what the runs on display have computed.
import type { ScenarioName } from "../protocol/frame";
import type { ObservedRow } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { number, unitText } from "../state/format";
import { pairedRows } from "../state/observed";
import { rerunning } from "../state/rerunning";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

const sign: Readonly<Record<ObservedRow["is"], string>> = { equal: "", at_least: "at least ", below: "below " };

export class ObservedTable {
  readonly element = h("div", { class: "observed-beside", hidden: true });
  private readonly rows = new Map<ScenarioName, readonly ObservedRow[]>();
  /** Whoever waits for it has the rows of now. */
  readonly refresh = rerunning(() => this.fetch());

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
  private async fetch(): Promise<void> {
    const { twin } = this;
    const names = twin.shown.value.filter((name) => twin.cells[name].setup.value !== null);
    if (names.length === 0 || twin.connection.value.state !== "open") return;
    await twin.attempt(async () => {
      for (const name of names) this.rows.set(name, (await twin.api.observed(name)).rows);
    });
    this.draw();
  }
  private draw(): void {
    const names = this.twin.shown.value;
    const all = pairedRows(names.map((name) => this.of(name))).flatMap((runs) => {
      const row = runs.find((one) => one !== null);
      return row ? [{ row, runs }] : [];
    });
    this.element.hidden = all.length === 0;
    this.element.replaceChildren(h("h3", {}, "Observed and computed"), h("table", { class: "plain observed" },
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Observation"), h("td", {}, "Observed"), ...names.map((name) => h("td", {}, names.length > 1 ? `Computed ${name}` : "Computed")))),
      h("tbody", {}, ...all.map(({ row, runs }) => h("tr", {}, h("th", { scope: "row" }, row.name),
        h("td", {}, `${sign[row.is]}${number(row.observed)} ± ${number(row.uncertainty, 2)}`, row.unit ? h("small", {}, ` ${unitText(row.unit)}`) : null),
        ...runs.map((own) => {
          const off = own?.deviation ?? null;
          return h("td", { title: off === null ? "" : `${number(Math.abs(off), 2)} standard deviations from the observation`, class: off !== null && Math.abs(off) > 2 ? "far" : "" }, number(own?.computed));
        }))))));
  }
}
