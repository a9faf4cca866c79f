import { defineConfig } from "vite";

// The page of published twins, in one script and one style sheet, and with PART=worker or loader the scripts of its worker and of
// what loads it: talus publish puts all of them into one file.
const inputs = { page: "src/published.ts", worker: "src/engine_worker.ts", loader: "src/loader.ts" };
const part = (process.env["PART"] ?? "page") as keyof typeof inputs;

export default defineConfig({
  build: {
    target: "es2022",
    outDir: "dist/published",
    emptyOutDir: part === "page",
    // A file that opens from disk loads nothing from beside it.
    assetsInlineLimit: Number.MAX_SAFE_INTEGER,
    cssCodeSplit: false,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1200,
    rollupOptions: {
      input: inputs[part],
      output: { inlineDynamicImports: true, entryFileNames: `${part}.js`, assetFileNames: "page[extname]" },
    },
  },
});
