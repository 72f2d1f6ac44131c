// The service worker: keeps every file of one build, so that the page works with the network off.
// The build puts in the list of files and its own name.

// Of the planner's two builds only the one that runs here is kept. An engine that knows no vectors
// finds this module, one function of (i32.const 0, i8x16.splat, i8x16.popcnt), invalid.
const VECTORS = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11];
const OTHER_BUILD = WebAssembly.validate(new Uint8Array(VECTORS)) ? "vantage_scalar" : "vantage_simd";
const FILES = "FILES".filter((name) => !name.includes(OTHER_BUILD));
const CACHE = `vantage-${"BUILD"}`;

self.addEventListener("install", (event) => {
  // All or nothing: a build that is half there is not used. `no-cache`: not an older build's copy.
  const requests = FILES.map((name) => new Request(name, { cache: "no-cache" }));
  event.waitUntil(caches.open(CACHE).then((cache) => cache.addAll(requests)).then(() => self.skipWaiting()));
});

self.addEventListener("activate", (event) => {
  const isOld = (name) => name.startsWith("vantage-") && name !== CACHE;
  event.waitUntil(
    caches.keys()
      .then((names) => Promise.all(names.filter(isOld).map((name) => caches.delete(name))))
      .then(() => self.clients.claim()),
  );
});

self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method !== "GET" || new URL(request.url).origin !== self.location.origin) return;
  event.respondWith(answer(request));
});

/** The page itself is asked of the network first, so that a new build is found; all else has names
 *  that change with the content. */
async function answer(request) {
  const cache = await caches.open(CACHE);
  if (request.mode === "navigate") {
    try {
      return await fetch(request);
    } catch {
      return (await cache.match("./")) ?? Response.error();
    }
  }
  return (await cache.match(request, { ignoreSearch: true })) ?? fetch(request);
}
