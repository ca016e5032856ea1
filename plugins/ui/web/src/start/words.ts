import { words } from "kit/words/words";

/** The start without a file, and the line that says how to feel. */
export const t = words({
  title: ["What do you want to feel?", "Was möchten Sie fühlen?", "Que voulez-vous toucher ?"],
  picture: ["A picture of mine", "Ein eigenes Bild", "Une image à moi"],
  pictureSays: ["A photograph or a drawing (SVG and PDF too), the left and right picture of a pair, or a height map. You can also drop it here.",
    "Ein Foto oder eine Zeichnung (auch SVG und PDF), linkes und rechtes Bild eines Paares oder eine Höhenkarte. Sie können es auch hier ablegen.",
    "Une photographie ou un dessin (aussi SVG et PDF), les images gauche et droite d'une paire, ou une carte de hauteurs. Vous pouvez aussi la déposer ici."],
  choose: ["Choose a picture", "Bild wählen", "Choisir une image"],
  example: ["An example", "Ein Beispiel", "Un exemple"],
  exampleSays: ["Pictures that come with the program.",
    "Bilder, die das Programm mitbringt.",
    "Des images fournies avec le programme."],
  file: ["A pipeline file", "Eine Pipeline-Datei", "Un fichier de pipeline"],
  fileSays: ["One that was saved on this computer before.",
    "Eine, die auf diesem Computer gespeichert wurde.",
    "Un fichier enregistré auparavant sur cet ordinateur."],
  folder: ["Choose from a folder", "Aus einem Ordner wählen", "Choisir dans un dossier"],
  feelByMouse: ["Move the mouse over the surface and hold its button down to feel it; or use the arrow keys and Space.",
    "Bewegen Sie die Maus über die Oberfläche, und halten Sie die Taste gedrückt, um zu fühlen; oder nehmen Sie Pfeiltasten und Leertaste.",
    "Déplacez la souris sur la surface en maintenant le bouton enfoncé pour la toucher ; ou utilisez les flèches et la barre d'espace."],
  feelByFinger: ["Put a finger on the surface to feel it.",
    "Legen Sie einen Finger auf die Oberfläche, um zu fühlen.",
    "Posez un doigt sur la surface pour la toucher."],
});
