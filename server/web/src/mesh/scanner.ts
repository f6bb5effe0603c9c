// Words and numbers out of a text's bytes, without a string for each.

const kNewline = 10;
const kReturn = 13;
const kPlus = 43;
const kMinus = 45;
const kPoint = 46;
const kZero = 48;
const kUpperE = 69;
const kLowerE = 101;

/** Powers of ten that doubles hold exactly. */
const kPowers = Array.from({ length: 23 }, (_, exponent) => Number(`1e${exponent}`));
const kMaxDigits = 15;

const isBlank = (byte: number): boolean => byte === 32 || byte === 9 || byte === kReturn || byte === 11 || byte === 12;
const isDigit = (byte: number): boolean => byte >= kZero && byte <= 57;

export class Scanner {
  at = 0;
  private readonly decoder = new TextDecoder("latin1");
  readonly bytes: Uint8Array;

  constructor(bytes: Uint8Array) {
    // Lines of old Macs end with a return alone.
    this.bytes = bytes.includes(kNewline) ? bytes : bytes.map((byte) => (byte === kReturn ? kNewline : byte));
  }

  get isAtEnd(): boolean {
    return this.at >= this.bytes.length;
  }

  /** Skips blanks. Output: whether a word of this line is there. */
  hasWord(): boolean {
    while (this.at < this.bytes.length && isBlank(this.bytes[this.at]!)) ++this.at;
    return this.at < this.bytes.length && this.bytes[this.at] !== kNewline;
  }

  /** Skips blanks, line ends and comments. Output: whether a word is there at all. */
  hasMore(): boolean {
    for (;;) {
      if (this.hasWord()) {
        if (this.bytes[this.at] !== 35 /* # */) return true;
        this.nextLine();
      } else if (this.isAtEnd) {
        return false;
      } else {
        ++this.at;
      }
    }
  }

  nextLine(): void {
    const end = this.bytes.indexOf(kNewline, this.at);
    this.at = end < 0 ? this.bytes.length : end + 1;
  }

  line(): string {
    const begin = this.at;
    this.nextLine();
    return this.decoder.decode(this.bytes.subarray(begin, this.at)).trim();
  }

  /** The word here; empty at the end of a line. */
  word(): string {
    if (!this.hasWord()) return "";
    const begin = this.at;
    this.skipWord();
    return this.decoder.decode(this.bytes.subarray(begin, this.at));
  }

  skipWord(): void {
    while (this.at < this.bytes.length && this.bytes[this.at] !== kNewline && !isBlank(this.bytes[this.at]!)) ++this.at;
  }

  /** The number here, NaN if there is none; exact, as Number() would read it. */
  number(): number {
    if (!this.hasWord()) return NaN;
    const { bytes } = this;
    const begin = this.at;
    let at = begin;
    const isNegative = bytes[at] === kMinus;
    if (isNegative || bytes[at] === kPlus) ++at;
    let mantissa = 0;
    let digits = 0;
    let scale = 0;
    let seen = 0;
    for (; at < bytes.length && isDigit(bytes[at]!); ++at, ++seen) {
      mantissa = mantissa * 10 + (bytes[at]! - kZero);
      if (mantissa > 0) ++digits;
    }
    if (bytes[at] === kPoint) {
      for (++at; at < bytes.length && isDigit(bytes[at]!); ++at, ++seen, --scale) {
        mantissa = mantissa * 10 + (bytes[at]! - kZero);
        if (mantissa > 0) ++digits;
      }
    }
    if (bytes[at] === kLowerE || bytes[at] === kUpperE) {
      let power = at + 1;
      const isSmall = bytes[power] === kMinus;
      if (isSmall || bytes[power] === kPlus) ++power;
      let exponent = 0;
      const first = power;
      for (; power < bytes.length && isDigit(bytes[power]!); ++power)
        exponent = exponent * 10 + (bytes[power]! - kZero);
      if (power > first) {
        scale += isSmall ? -exponent : exponent;
        at = power;
      }
    }
    this.at = at;
    const isAtWordEnd = at >= bytes.length || isBlank(bytes[at]!) || bytes[at] === kNewline;
    if (seen > 0 && isAtWordEnd && digits <= kMaxDigits && Math.abs(scale) <= 22) {
      const value = scale < 0 ? mantissa / kPowers[-scale]! : mantissa * kPowers[scale]!;
      return isNegative ? -value : value;
    }
    this.at = begin;
    const text = this.word();
    return text === "" ? NaN : Number(text);
  }
}
