// What is fetched once for each entry of a list that changes.

export class Fetched<K extends { id: string }, T> {
  private readonly there = new Map<string, T>();
  /** Those that are under way, or have failed. */
  private readonly asked = new Set<string>();
  private readonly failed = new Set<string>();

  /** fetch: null: it could not be had. arrived: there is one more. drop: it is not needed any more. */
  constructor(private readonly fetch: (entry: K) => Promise<T | null>, private readonly arrived: () => void, private readonly drop: (content: T) => void) {}

  /** null: not yet, or it could not be had; nothing is asked for by it. */
  held(id: string): T | null {
    return this.there.get(id) ?? null;
  }
  /** Asks for it if nobody has; one that could not be had is asked for again only after the list has changed. */
  of(entry: K): T | null {
    const { id } = entry;
    if (!this.there.has(id) && !this.asked.has(id)) {
      this.asked.add(id);
      void this.fetch(entry).then((content) => this.take(id, content));
    }
    return this.held(id);
  }
  /** The list has changed to this one. */
  keep(list: readonly K[]): void {
    const known = new Set(list.map(({ id }) => id));
    for (const [id, content] of [...this.there]) {
      if (known.has(id)) continue;
      this.there.delete(id);
      this.drop(content);
    }
    for (const id of [...this.asked]) if (!known.has(id) || this.failed.has(id)) this.asked.delete(id);
    this.failed.clear();
  }
  private take(id: string, content: T | null): void {
    // One that has left the list meanwhile, or came by another question, is not taken.
    const wanted = this.asked.has(id);
    if (content === null) {
      if (wanted) this.failed.add(id);
    } else if (wanted) {
      this.asked.delete(id);
      this.there.set(id, content);
      this.arrived();
    } else this.drop(content);
  }
}
