/** Native controls for values of every kind. A control shows a value and reports changes by a person. */
import { button } from "kit/elements";
import { t } from "./words";
import { type Kind, type Option, step } from "./kinds";
import type { Plain } from "kit/server/messages";
import { asText, fits, isMap, numberText, setInside, same, type FieldChange, typedNumber, typedText, typedYaml } from "./values";

export interface Control {
  root: HTMLElement;
  /** The labelled element, to which a complaint leads. */
  main: HTMLElement;
  /** Show a value, unless it is being edited. isSet: the document has it, else it is the default. */
  show(value: Plain | undefined, isSet: boolean): void;
}

/** Reports a change. inside: path within the value, if it is not the whole. */
export type Tell = (change: FieldChange, inside?: string[]) => void;

/** Builds a row with label and help around a control. */
export type Row = (option: Option, id: string, tell: Tell) => { root: HTMLElement; show: Control["show"] };

export function control(kind: Kind, id: string, tell: Tell, row: Row): Control {
  switch (kind.kind) {
    case "switch":
      return toggle(id, tell);
    case "choice":
      return choice(kind.values, id, tell);
    case "number":
      return number(kind, id, tell);
    case "text":
      return text(id, (typed) => tell(typedText(typed, kind.nullable, t("none"))));
    case "tuple":
      return tuple(kind, id, tell, row);
    case "block":
      return block(kind.options, id, tell, row);
    case "list":
      return list(kind.item, id, tell, row);
    case "either":
      return either(kind, id, tell, row);
    case "yaml":
      return text(id, (typed) => tell(typedYaml(typed)), { isYaml: true });
  }
}

/** Return the control of a kind; a field of YAML replaces it for a value that it cannot show. */
export function controlOrYaml(kind: Kind, id: string, tell: Tell, row: Row): Control {
  let shown = control(kind, id, tell, row);
  let inYaml = kind.kind === "yaml";
  const inner: Control = {
    root: holder(shown.root),
    main: shown.main,
    show: (value, isSet) => {
      if (kind.kind !== "yaml" && fits(value, kind) === inYaml) {
        inYaml = !inYaml;
        shown = control(inYaml ? { kind: "yaml" } : kind, id, tell, row);
        inner.root.replaceChildren(shown.root);
        inner.main = shown.main;
      }
      shown.show(value, isSet);
    },
  };
  return inner;
}

function holder(inside: HTMLElement): HTMLElement {
  const box = document.createElement("div");
  box.className = "control";
  box.append(inside);
  return box;
}

function toggle(id: string, tell: Tell): Control {
  const input = document.createElement("input");
  input.type = "checkbox";
  input.id = id;
  input.onchange = () => tell({ value: input.checked });
  return { root: input, main: input, show: (value) => (input.checked = value === true) };
}

function choice(values: Plain[], id: string, tell: Tell): Control {
  const select = document.createElement("select");
  select.id = id;
  values.forEach((each, at) => select.add(new Option(word(each), String(at))));
  select.onchange = () => tell({ value: values[Number(select.value)] });
  return {
    root: select,
    main: select,
    show: (value) => (select.selectedIndex = values.findIndex((each) => same(each, value))),
  };
}

function number(kind: Kind & { kind: "number" }, id: string, tell: Tell): Control {
  const plain = !kind.units.length && !kind.words.length && !kind.nullable;
  const control = text(id, (typed, input) => {
    if (input.validity.badInput) input.reportValidity();
    else tell(typedNumber(typed, kind, t("none")));
  }, { spell: plain ? asText : numberText });
  const input = control.main as HTMLInputElement;
  const { least, most } = kind.bounds;
  if (plain) {
    input.type = "number";
    input.step = String(step(kind.integer, kind.bounds));
    if (least !== undefined) input.min = String(least);
    if (most !== undefined) input.max = String(most);
  } else {
    input.inputMode = kind.words.length || kind.units.length ? "text" : "decimal";
    const words = [...kind.words, ...(kind.nullable ? [t("none")] : [])];
    if (words.length) suggest(control.root, input, words);
  }
  return control;
}

/** Return a line of text; reported when left or on Enter, and not overwritten while typing. */
function text(id: string, typed: (text: string, input: HTMLInputElement) => void, { isYaml = false, spell = asText } = {}): Control {
  const input = document.createElement("input");
  input.id = id;
  input.spellcheck = false;
  input.autocomplete = "off";
  if (isYaml) input.className = "mono";
  let typing = false;
  let shown: Plain | undefined;
  const show = (value: Plain | undefined): void => {
    shown = value;
    if (!typing) input.value = spell(value, t("none"));
  };
  input.addEventListener("input", () => (typing = true));
  input.addEventListener("change", () => {
    typing = false;
    typed(input.value, input);
  });
  input.addEventListener("blur", () => {
    typing = false;
    if (!input.value && !input.validity.badInput) show(shown); // empty: the default is shown
  });
  input.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !typing) return;
    typing = false;
    show(shown);
    event.stopPropagation();
  });
  return { root: holder(input), main: input, show };
}

function suggest(root: HTMLElement, input: HTMLInputElement, words: string[]): void {
  const list = document.createElement("datalist");
  list.id = `${input.id}-words`;
  for (const each of words) list.append(new Option(each, each));
  input.setAttribute("list", list.id);
  root.append(list);
}

function tuple(kind: Kind & { kind: "tuple" }, id: string, tell: Tell, row: Row): Control {
  const box = group();
  box.classList.add("tuple");
  let now: (Plain | undefined)[] = kind.parts.map(() => undefined);
  const parts = kind.parts.map((part, at) => {
    const inner = control(part, `${id}.${at}`, (change) => {
      now[at] = "value" in change ? change.value : undefined;
      if (now.every((each) => each !== undefined)) tell({ value: now as Plain[] });
      else if (now.every((each) => each === undefined)) tell({ gone: true });
    }, row);
    inner.main.setAttribute("aria-label", t("part", { number: at + 1, of: kind.parts.length }));
    box.append(inner.root);
    return inner;
  });
  return {
    root: box,
    main: parts[0].main,
    show: (value, isSet) => {
      const given: Plain[] = Array.isArray(value) ? value : [];
      now = kind.parts.map((_, at) => given[at]);
      parts.forEach((each, at) => each.show(given[at], isSet));
    },
  };
}

function block(options: Option[], id: string, tell: Tell, row: Row): Control {
  const box = group();
  const rows = options.map((option) => {
    const made = row(option, `${id}.${option.name}`, (change, inside = []) => tell(change, [option.name, ...inside]));
    box.append(made.root);
    return made;
  });
  return {
    root: box,
    main: box,
    show: (value, isSet) =>
      rows.forEach((each, at) => {
        const part = isMap(value) ? value[options[at].name] : undefined;
        each.show(part, isSet && part !== undefined);
      }),
  };
}

function list(item: Kind, id: string, tell: Tell, row: Row): Control {
  const box = group();
  const items = document.createElement("div");
  let now: Plain[] = [];
  let shown: Control[] = [];
  const add = button(t("add"), () => {
    build([...now, {}]);
    shown.at(-1)!.root.querySelector<HTMLElement>("input, select")?.focus();
  });
  add.id = id;
  box.append(items, add);

  function build(values: Plain[]): void {
    now = values;
    shown = values.map((_, at) => entry(at));
    items.replaceChildren(...shown.map((each) => each.root));
    shown.forEach((each, at) => each.show(now[at], true));
  }

  function entry(at: number): Control {
    const control = controlOrYaml(item, `${id}.${at}`, (change, inside = []) => {
      now = now.map((each, one) => (one === at ? setInside(each, inside, change) : each));
      tell({ value: now });
    }, row);
    control.root.classList.add("item");
    control.root.setAttribute("role", "group");
    control.root.setAttribute("aria-label", t("entry", { number: at + 1 }));
    const remove = button(t("remove", { number: at + 1 }), () => {
      const left = now.filter((_, one) => one !== at);
      tell(left.length ? { value: left } : { gone: true });
      add.focus();
    });
    remove.className = "quiet";
    control.root.append(remove);
    return control;
  }

  return {
    root: box,
    main: add,
    show: (value) => {
      const given = Array.isArray(value) ? value : [];
      if (given.length !== shown.length) build(given);
      now = given;
      shown.forEach((each, at) => each.show(given[at], true));
    },
  };
}

function either(kind: Kind & { kind: "either" }, id: string, tell: Tell, row: Row): Control {
  const box = document.createElement("div");
  const select = document.createElement("select");
  select.id = id;
  kind.words.forEach((each, at) => select.add(new Option(word(each), String(at))));
  select.add(new Option(t(kind.other.kind === "yaml" ? "inYaml" : "ofMyOwn"), "other"));
  const other = control(kind.other, kind.other.kind === "block" ? id : `${id}.other`, tell, row);
  other.root.hidden = true;
  if (kind.other.kind === "yaml") other.main.setAttribute("aria-label", t("inYaml"));
  select.onchange = () => {
    other.root.hidden = select.value !== "other";
    if (select.value !== "other") tell({ value: kind.words[Number(select.value)] });
  };
  box.append(select, other.root);
  return {
    root: box,
    main: select,
    show: (value, isSet) => {
      const at = kind.words.findIndex((each) => same(each, value));
      if (at < 0 && value === undefined) return;
      if (at < 0) other.show(value, isSet);
      if (document.activeElement === select && select.value === "other" && at >= 0 && !other.root.hidden) return;
      select.value = at < 0 ? "other" : String(at);
      other.root.hidden = at >= 0;
    },
  };
}

function group(): HTMLElement {
  const box = document.createElement("div");
  box.setAttribute("role", "group");
  box.className = "group";
  return box;
}

function word(value: Plain): string {
  if (value === null) return t("none");
  if (typeof value === "boolean") return t(value ? "yes" : "no");
  return String(value);
}
