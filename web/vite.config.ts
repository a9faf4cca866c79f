import { defineConfig } from "vite";

// `npm run dev` shows the sources as they are, on a running `talus serve`: TALUS_SERVER says where, else its usual address.
const target = process.env["TALUS_SERVER"] ?? "http://127.0.0.1:8123";
// The server refuses what comes from pages of other origins.
const proxy = { target, changeOrigin: true, headers: { origin: target } };

export default defineConfig({
  base: "./",
  server: { proxy: { "/api": proxy, "/ws": { ...proxy, ws: true } } },
  build: {
    target: "es2022",
    // The page's Content-Security-Policy refuses data: URLs, so nothing is put inline.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 900,
  },
});
