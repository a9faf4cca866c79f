// One page that compares two scenarios: views, values, front velocity. It needs nothing but itself.
import type { Series } from "../protocol/messages";
import { differenceText, type Row } from "../state/comparison";
import { paneText } from "../state/differences";
import { tick, unitText } from "../state/format";
import { pressures } from "../state/pressures";
import { roundStep } from "../scene/colour";
import type { Twin } from "../state/twin";
import { shownValue, standing, timeSoFar } from "./comparison_text";

const escape = (text: string): string => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const colours = ["#0b5fa5", "#d1640f"];

interface Line { x: readonly (number | null)[]; y: readonly (number | null)[] }

function chart(title: string, xTitle: string, yTitle: string, lines: readonly Line[]): string {
  const points = lines.map(({ x, y }) => x.flatMap((v, k): [number, number][] => (v === null || (y[k] ?? null) === null ? [] : [[v, y[k] ?? 0]])));
  const all = points.flat();
  if (all.length === 0) return "";
  const [right, top] = [Math.max(...all.map((p) => p[0]), 1e-9), Math.max(...all.map((p) => p[1]), 1e-9)];
  const left = Math.min(...all.map((p) => p[0]));
  const [width, height, edge] = [340, 150, 34];
  const px = (x: number): number => edge + ((x - left) / (right - left || 1)) * (width - edge - 6);
  const py = (y: number): number => height - 26 - (y / top) * (height - 36);
  const ticks = (low: number, high: number): number[] => {
    const step = roundStep((high - low) / 4.5 || 1);
    return Array.from({ length: 12 }, (_, k) => (Math.ceil(low / step) + k) * step).filter((v) => v <= high * 1.0001);
  };
  const grid = ticks(0, top).map((v) => `<path d="M${edge} ${py(v)}H${width - 6}" stroke="#e4e8eb"/><text x="${edge - 4}" y="${py(v) + 3}" text-anchor="end">${tick(v)}</text>`)
    .concat(ticks(left, right).map((v) => `<text x="${px(v)}" y="${height - 14}" text-anchor="middle">${tick(v)}</text>`));
  const curves = points.map((list, i) => `<polyline fill="none" stroke="${colours[i]}" stroke-width="1.6"${i === 1 ? ' stroke-dasharray="5 3"' : ""} points="${list.map(([x, y]) => `${px(x).toFixed(1)},${py(y).toFixed(1)}`).join(" ")}"/>`);
  return `<figure><figcaption>${escape(title)}</figcaption><svg viewBox="0 0 ${width} ${height}">${grid.join("")}${curves.join("")}<text x="${width / 2}" y="${height - 2}" text-anchor="middle">${escape(xTitle)}</text><text x="2" y="8">${escape(yTitle)}</text></svg></figure>`;
}

export function comparisonReport(twin: Twin, rows: readonly Row[], rest: string, picture: string): string {
  const { shown: { value: shown }, scene } = twin;
  const series = shown.map((name): Series | null => twin.cells[name].series.value);
  const heads = shown.map((name, i) => `<p><b style="color:${colours[i]}">${escape(paneText(twin, name))}</b>: ${escape(standing(twin, name))}</p>`);
  let group = "";
  const body = rows.map((row) => {
    const head = row.group === group ? "" : `<tr class="g"><th colspan="4">${escape(row.group)}</th></tr>`;
    group = row.group;
    return `${head}<tr><th>${escape(row.name)}${row.unit ? `, ${escape(unitText(row.unit))}` : ""}</th><td>${escape(shownValue(row.a))}</td><td>${escape(shownValue(row.b))}</td><td>${differenceText(row)}</td></tr>`;
  });
  const front = chart("Front velocity along the flow path", "Chainage, m", "m/s", series.map((s) => ({ x: s?.front.chainage_m ?? [], y: s?.front.front_velocity_mps ?? [] })));
  const moving = chart("Volume in motion", "Time, s", "m³", series.map((s) => ({ x: s?.time["time_s"] ?? [], y: s?.time["volume_moving_m3"] ?? [] })));
  return `<!doctype html><html lang="en"><meta charset="utf-8"><title>${escape(`Comparison: ${scene.title}`)}</title><style>
@page { size: A4; margin: 12mm } body { font: 9.5pt/1.3 system-ui, "DejaVu Sans", sans-serif; color: #1c2126; max-width: 186mm; margin: 0 auto; padding: 4mm 0 }
h1 { font-size: 14pt; margin: 0 0 4px } p { margin: 2px 0 } img { display: block; max-width: 100%; max-height: 92mm; margin: 6px auto } .two { display: grid; grid-template-columns: 1.15fr 1fr; gap: 6mm }
table { border-collapse: collapse; width: 100%; font-size: 8pt; font-variant-numeric: tabular-nums } th { text-align: left; font-weight: 400 } td { text-align: right }
tr { border-bottom: 1px solid #e4e8eb } thead th, .g th { font-weight: 600 } thead th + th { text-align: right } figure { margin: 0 0 4mm } figcaption { font-weight: 600 } svg { width: 100%; font-size: 8px } small { color: #5a646e }
</style><h1>${escape(scene.title)}: comparison of ${shown.join(" and ")}</h1>${heads.join("")}
<img alt="Both views" src="${picture}"><div class="two"><div><table><thead><tr><th></th>${shown.map((name) => `<th>${name} <small>${timeSoFar(twin, name)}</small></th>`).join("")}<th>${escape(twin.differenceName)}</th></tr></thead><tbody>${body.join("")}</tbody></table><p><small>${escape(rest)}</small></p></div>
<div>${front}${moving}<p><small>${shown[0]} solid, ${shown[1]} dashed. ${escape(pressures)} Compared on ${new Date().toISOString().slice(0, 16).replace("T", " ")} UTC.</small></p></div></div></html>
`;
}
