// Making elements in one expression.
export const element = <K extends keyof HTMLElementTagNameMap>(tag: K, properties: Record<string, unknown> = {}, ...children: (Node | string)[]) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};
export const byId = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

/** Saves bytes as a file of the user's. */
export function download(name: string, data: Blob): void {
  const link = element('a', {href: URL.createObjectURL(data), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
