'use strict';
// Pictures stand in the page once; other places show copies.
for (const image of document.querySelectorAll('img[data-picture]')) {
  image.src = document.getElementById(image.dataset.picture).src;
}
// On a narrow screen the contents would push the text out of sight.
if (matchMedia('(max-width: 88rem)').matches) {
  document.querySelector('nav details').open = false;
}
for (const stage of document.querySelectorAll('[data-stage]')) {
  const range = stage.querySelector('input');
  const show = () => stage.style.setProperty('--split', range.value + '%');
  const follow = (event) => {
    const box = stage.getBoundingClientRect();
    const share = (event.clientX - box.left) / box.width;
    range.value = Math.round(100 * Math.min(1, Math.max(0, share)));
    show();
  };
  range.addEventListener('input', show);
  stage.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    // The range would jump by itself otherwise.
    event.preventDefault();
    range.focus({ preventScroll: true });
    stage.setPointerCapture(event.pointerId);
    follow(event);
  });
  stage.addEventListener('pointermove', (event) => {
    if (stage.hasPointerCapture(event.pointerId)) follow(event);
  });
  show();
}
document.documentElement.classList.add('ready');
