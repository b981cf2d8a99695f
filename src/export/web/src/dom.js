// Elements in one line, and numbers for people.

/** An element with attributes (functions become listeners) and children (elements or text). */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(name, value);
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/** Four digits; what is not a number stays as it is. */
export function short(value) {
  const number = typeof value === 'number' ? value : value === '' || value === null ? NaN : Number(value);
  if (!Number.isFinite(number)) return value === null || value === undefined ? '' : String(value);
  if (Number.isInteger(number) && Math.abs(number) < 1e15) return number.toLocaleString('en-US').replaceAll(',', '\u2009');
  const size = Math.abs(number);
  return size >= 1e5 || size < 1e-3 ? number.toExponential(3).replace('e+', 'e') : String(Number(number.toPrecision(4)));
}

/** Rows of a table of comma-separated values (RFC 4180), the header first. */
export function parseCsv(text) {
  const rows = [];
  let row = [''];
  let quoted = false;
  for (let i = 0; i < text.length; ++i) {
    const c = text[i];
    if (quoted) {
      if (c !== '"') row[row.length - 1] += c;
      else if (text[i + 1] === '"') row[row.length - 1] += text[++i];
      else quoted = false;
    } else if (c === '"') quoted = true;
    else if (c === ',') row.push('');
    else if (c === '\n') {
      rows.push(row);
      row = [''];
    } else if (c !== '\r') row[row.length - 1] += c;
  }
  if (row.length > 1 || row[0] !== '') rows.push(row);
  return rows;
}

/** Okabe and Ito (2008): told apart with every common colour blindness. */
export const kColors = ['#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9', '#000000', '#8C6D00'];
