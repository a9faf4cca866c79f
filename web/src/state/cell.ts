/** A value that notifies its readers of changes. */
export class Cell<T> {
  private readonly readers = new Set<(value: T) => void>();

  constructor(private held: T) {}

  get value(): T {
    return this.held;
  }
  set value(next: T) {
    if (Object.is(next, this.held)) return;
    this.held = next;
    for (const reader of [...this.readers]) reader(next);
  }
  /** Calls `reader` now and on every change; call the result to end this. */
  watch(reader: (value: T) => void): () => void {
    this.readers.add(reader);
    reader(this.held);
    return () => void this.readers.delete(reader);
  }
}

interface Watched {
  watch(reader: () => void): () => void;
}

/** Calls `reader` now and whenever one of the cells changes, at most once per task. */
export function watchAll(cells: readonly Watched[], reader: () => void): () => void {
  let due = false;
  let ended = false;
  let begun = false;
  const ends = cells.map((cell) =>
    cell.watch(() => {
      if (!begun || due) return;
      due = true;
      queueMicrotask(() => {
        due = false;
        if (!ended) reader();
      });
    }),
  );
  begun = true;
  reader();
  return () => {
    ended = true;
    for (const end of ends) end();
  };
}
