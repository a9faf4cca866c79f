import { defineConfig } from "vite";

// The page of published twins, in one script and one style sheet: talus publish puts both into one file.
export default defineConfig({
  build: {
    target: "es2022",
    outDir: "dist/published",
    emptyOutDir: true,
    // A file that opens from disk loads nothing from beside it.
    assetsInlineLimit: Number.MAX_SAFE_INTEGER,
    cssCodeSplit: false,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1200,
    rollupOptions: {
      input: "src/published.ts",
      output: { inlineDynamicImports: true, entryFileNames: "page.js", assetFileNames: "page[extname]" },
    },
  },
});
