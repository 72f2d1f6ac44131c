// What goes wrong in the ordinary course of things, in a sentence that says what to do. Whatever else
// is thrown is a fault of the page, and is written to the console too.

export class Advice extends Error {}
