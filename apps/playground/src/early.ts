// Runs before main.ts has come: the engine is on its way while the page's own script still is.
export interface WithEngine { engine?: Worker }

const page = window as WithEngine;
page.engine = new Worker(new URL('worker.js', document.baseURI), {type: 'module'});
// Then the page tries itself, and says what is wrong.
page.engine.onerror = () => { page.engine = undefined; };
