/** The number by which people know a part or a segment: counted from 1, as in files; labels are from 0. */
export const shownNumber = (label: number): number => label + 1;
