/** A text as it is spoken: without what an eye skips, and an ear cannot. */

/** A path from the root, the home or here on, or to a file with an ending; its last name is a group. */
const PATH = /(?<![\w/\\.])(?:(?:[A-Za-z]:|~|\.{1,2})?[\\/](?:[^\s\\/"'“”„:;,()]+[\\/])+([^\s\\/"'“”„:;,()]+)|(?:[\w.-]+[\\/])+([\w-]+\.[A-Za-z]\w{1,4}))/g;
/** A module of the program, "tangible_ui.worker.state: ". */
const MODULE = /\btangible_\w+(?:\.\w+)*(?:: *)?/g;

/** Return a text with the names of files in place of their paths, and without names of modules. */
export function speakable(text: string): string {
  return text.replace(PATH, (_, absolute?: string, relative?: string) => absolute ?? relative!).replace(MODULE, "");
}
