/** The graph of imports of the pages' sources, and its circles. */
import { posix } from "node:path";

type Graph = Map<string, string[]>;

const IMPORT = /\b(?:from|import)\s*\(?\s*"((?:\.{1,2}|kit)\/[^"]+)"/g;

/** Return of each TypeScript file the ones that it imports: values, types, dynamically, or to export them again. */
export function imports(files: { name: string; text: string }[]): Graph {
  const names = new Set(files.map(({ name }) => name));
  return new Map(files.map(({ name, text }) => [name, targets(name, text, names)]));
}

function targets(name: string, text: string, names: Set<string>): string[] {
  const paths = [...text.matchAll(IMPORT)].map(([, path]) => pathOf(path!, name)).filter((path) => !path.endsWith(".css"));
  return [...new Set(paths)].map((path) => {
    const target = [`${path}.ts`, `${path}/index.ts`].find((each) => names.has(each));
    if (!target) throw new Error(`${name} imports ${path}, which is not there`);
    return target;
  });
}

function pathOf(path: string, from: string): string {
  return path.startsWith("kit/") ? `web/${path}` : posix.join(posix.dirname(from), path);
}

/** Return the strongly connected components of more than one file, each sorted (Tarjan 1972). */
export function circles(graph: Graph): string[][] {
  const index = new Map<string, number>();
  const low = new Map<string, number>();
  const stack: string[] = [];
  const found: string[][] = [];
  const visit = (file: string): void => {
    index.set(file, index.size);
    low.set(file, index.get(file)!);
    stack.push(file);
    for (const next of graph.get(file) ?? []) {
      if (!index.has(next)) visit(next);
      if (stack.includes(next)) low.set(file, Math.min(low.get(file)!, low.get(next)!));
    }
    if (low.get(file) !== index.get(file)) return;
    const component = stack.splice(stack.indexOf(file));
    if (component.length > 1) found.push(component.sort());
  };
  for (const file of graph.keys()) if (!index.has(file)) visit(file);
  return found;
}
