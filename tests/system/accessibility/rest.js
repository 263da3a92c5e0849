// Brings what moves to its end, so that the page is looked over at rest.
for (const moving of document.getAnimations()) {
  if (moving.effect.getComputedTiming().iterations === Infinity) moving.cancel();
  else moving.finish();
}
