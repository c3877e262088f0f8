// What a JSON Schema says about a place in a document: which keys and values belong there. Only what the scene files'
// own schema uses: $ref, anyOf, properties, additionalProperties, items, enum, type, description.
import definition from '../../../scenes/schema/carom-scene.schema.json';

export interface Schema {
  $ref?: string; anyOf?: Schema[]; description?: string; type?: string | string[]; enum?: unknown[]; const?: unknown;
  properties?: Record<string, Schema>; additionalProperties?: boolean | Schema; items?: Schema; required?: string[];
}
const root = definition as unknown as Schema & {$defs: Record<string, Schema>};

/** The schema itself and its alternatives, without references. */
function plain(schema: Schema): Schema[] {
  if (schema.$ref) {
    const {$ref, ...own} = schema;
    return plain(root.$defs[$ref.slice($ref.lastIndexOf('/') + 1)] ?? {}).map((s) => ({...s, ...own}));
  }
  return schema.anyOf ? schema.anyOf.flatMap((s) => plain({...s, description: s.description ?? schema.description})) : [schema];
}

/** Where a path of keys and places of arrays leads; several schemas where there are alternatives. */
export function schemasAt(path: (string | number)[]): Schema[] {
  let found = plain(root);
  for (const step of path) {
    found = found.flatMap((s) => {
      if (typeof step === 'number') return s.items ? plain(s.items) : [];
      const property = s.properties?.[step];
      if (property) return plain(property);
      return typeof s.additionalProperties === 'object' ? plain(s.additionalProperties) : [];
    });
  }
  return found;
}

export interface Key { name: string; schema: Schema; required: boolean }
export function keysAt(path: (string | number)[]): Key[] {
  const keys = new Map<string, Key>();
  for (const s of schemasAt(path))
    for (const [name, property] of Object.entries(s.properties ?? {}))
      if (!keys.has(name)) keys.set(name, {name, schema: {...plain(property)[0], description: property.description ?? plain(property)[0].description}, required: s.required?.includes(name) ?? false});
  return [...keys.values()];
}

/** Values that the schema lists. */
export function valuesAt(path: (string | number)[]): unknown[] {
  return [...new Set(schemasAt(path).flatMap((s) => s.enum ?? (s.const !== undefined ? [s.const] : types(s).includes('boolean') ? [true, false] : [])))];
}

export const types = (s: Schema): string[] => (Array.isArray(s.type) ? s.type : s.type ? [s.type] : []);
/** In a word: "length", "array", "object" … */
export function kindOf(s: Schema): string {
  if (s.enum) return s.enum.slice(0, 3).join(' | ') + (s.enum.length > 3 ? ' …' : '');
  return types(s).join(' or ');
}
