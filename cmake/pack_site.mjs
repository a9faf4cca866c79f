// Packs the files of a folder into one: a line "SIZE NAME" for each, an empty line, then the contents one after the other.
//   node pack_site.mjs FOLDER ARCHIVE
import { readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join, relative, sep } from "node:path";

const [folder, archive] = process.argv.slice(2);

function files(below) {
  return readdirSync(below).flatMap((name) => {
    const path = join(below, name);
    return statSync(path).isDirectory() ? files(path) : [path];
  });
}

// Sorted, so that the same page makes the same program; maps of the sources are for those who develop the page.
const paths = files(folder).filter((path) => !path.endsWith(".map")).sort();
const contents = paths.map((path) => readFileSync(path));
const index = paths.map((path, i) => `${contents[i].length} ${relative(folder, path).split(sep).join("/")}\n`);
writeFileSync(archive, Buffer.concat([Buffer.from(index.join("") + "\n"), ...contents]));
