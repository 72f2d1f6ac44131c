// Whether this browser follows itself in AR. Small, since every visitor loads it; the rest only who asks.

export async function offersAr(): Promise<boolean> {
  // A page policy or a missing service throws: then there is no AR.
  return (await navigator.xr?.isSessionSupported("immersive-ar").catch(() => false)) ?? false;
}
