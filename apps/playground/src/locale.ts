// Before any module that formats numbers: some browsers hand on a system's language that is none ("C"), and Intl throws at it.
try {
  Intl.getCanonicalLocales(navigator.language);
} catch {
  Object.defineProperty(navigator, 'language', {value: 'en', configurable: true});
}
export {};
