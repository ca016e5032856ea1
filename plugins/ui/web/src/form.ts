/** A form from the project's JSON Schema: one method of a stage, and its options, as native controls. */
type Schema = Record<string, any>;

export class StageForm {
  private defs: Schema;
  private forms: Map<string, Schema>;
  private values: Record<string, unknown> = {};
  private fields = document.createElement("div");
  private choice = document.createElement("select");

  constructor(
    root: HTMLElement,
    schema: Schema,
    private stage: string,
    private onChange: (block: object) => void,
  ) {
    this.defs = schema.$defs;
    this.forms = new Map(
      schema.properties[stage].anyOf.slice(1).map((form: Schema) => [form.properties.use.const, form]),
    );
    this.choice.id = `${stage}-use`;
    for (const name of this.forms.keys()) this.choice.add(new Option(name));
    this.choice.onchange = () => this.choose(this.choice.value, {}, true);
    root.append(label(`${stage} method`, this.choice), this.fields);
  }

  choose(use: string, values: Record<string, unknown>, tell = false) {
    this.choice.value = use;
    this.values = { ...values };
    const form = this.forms.get(use)!;
    this.fields.replaceChildren(
      ...Object.entries<Schema>(form.properties)
        .filter(([name]) => name !== "use")
        .map(([name, option]) => this.field(name, option)),
    );
    if (tell) this.tell();
  }
  private tell() {
    this.onChange({ use: this.choice.value, ...this.values });
  }

  private field(name: string, option: Schema): HTMLElement {
    const id = `${this.stage}-${name}`,
      value = this.values[name] ?? option.default,
      flat = this.flat(option);
    const words = flat.flatMap((each) => each.enum ?? (each.const !== undefined ? [each.const] : []));
    let control: HTMLInputElement | HTMLSelectElement;
    if (flat.length === 1 && flat[0].type === "boolean") {
      control = document.createElement("input");
      control.type = "checkbox";
      control.checked = !!value;
    } else if (words.length && flat.every((each) => each.enum || each.const !== undefined)) {
      control = document.createElement("select");
      for (const word of words) control.add(new Option(String(word)));
      control.value = String(value);
    } else {
      control = document.createElement("input");
      const number = flat.find((each) => each.type === "number" || each.type === "integer");
      if (number && flat.length === 1) {
        control.type = "number";
        control.step = number.type === "integer" ? "1" : "any";
        if ("minimum" in number) control.min = number.minimum;
        if ("maximum" in number) control.max = number.maximum;
      }
      control.value = value == null ? "" : typeof value === "object" ? JSON.stringify(value) : String(value);
    }
    control.id = id;
    const help = document.createElement("small");
    help.id = `${id}-help`;
    help.textContent = option.description ?? "";
    control.setAttribute("aria-describedby", help.id);
    control.addEventListener("change", () => {
      if (control instanceof HTMLInputElement && control.type === "checkbox") this.values[name] = control.checked;
      else if (control.value === "") delete this.values[name];
      else
        try {
          this.values[name] = JSON.parse(control.value);
        } catch {
          this.values[name] = control.value;
        }
      if (control.checkValidity()) this.tell();
      else control.reportValidity();
    });
    const box = document.createElement("div");
    box.className = "field";
    box.append(label(name.replaceAll("_", " "), control), help);
    return box;
  }
  private flat(option: Schema): Schema[] {
    if (option.$ref) return this.flat(this.defs[option.$ref.split("/").at(-1)]);
    return (option.anyOf ?? option.oneOf)?.flatMap((each: Schema) => this.flat(each)) ?? [option];
  }
}

function label(text: string, control: HTMLElement): HTMLLabelElement {
  const made = document.createElement("label");
  made.htmlFor = control.id;
  made.append(text, control);
  return made;
}
