import { defineConfig } from "vite";

// The page of published twins, in one script and one style sheet, and with PART=worker the script of its worker: talus publish
// puts all of them into one file.
const part = process.env["PART"] === "worker" ? "worker" : "page";

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
      input: part === "page" ? "src/published.ts" : "src/engine_worker.ts",
      output: { inlineDynamicImports: true, entryFileNames: `${part}.js`, assetFileNames: "page[extname]" },
    },
  },
});
