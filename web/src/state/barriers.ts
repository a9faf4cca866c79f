// Values of barriers other than their line, as sent to the server.
import type { Barrier, BarrierOpening } from "../protocol/messages";
import type { BarrierValues } from "../protocol/schema";

export type BarrierSet = Partial<BarrierValues & Pick<Barrier, "openings">>;

/** The openings with one number of one of them changed; unchanged if that is not a number. */
export function openingsWith(openings: readonly BarrierOpening[], index: number, key: keyof BarrierOpening, value: number): BarrierOpening[] {
  return openings.map((o, k) => (k === index && Number.isFinite(value) && value >= 0 ? { ...o, [key]: value } : o));
}

/** In a list: "net, 40 % pass, 2 openings". */
export function barrierNote(barrier: BarrierSet): string {
  const said: string[] = [];
  if (typeof barrier.passing_share === "number") said.push(`net, ${Number((100 * barrier.passing_share).toPrecision(3))} % pass`);
  const count = barrier.openings?.length ?? 0;
  if (count > 0) said.push(count === 1 ? "1 opening" : `${count} openings`);
  return said.map((s) => `, ${s}`).join("");
}
