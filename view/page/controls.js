// SPDX-License-Identifier: Apache-2.0
// Sliders, switches and choices, with names for those who do not see them. Text is set as text, never as HTML.

let count = 0;

/// element('div', {class: 'a', hidden: true}, 'text', child ..)
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes))
    if (typeof value === 'function') made.addEventListener(key, value);
    else if (value === true) made.setAttribute(key, '');
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const kSvg = 'http://www.w3.org/2000/svg';
export function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS(kSvg, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/// A part of the panel, which opens and closes. Its methods add controls; each returns an object with `set(value)`,
/// which changes what is shown without calling back, and `element`.
export class Section {
  constructor(title, open = true) {
    this.body = element('div', {class: 'body'});
    this.element = element('details', {class: 'section'}, element('summary', {}, title), this.body);
    this.element.open = open;
  }

  row(...children) {
    const row = element('div', {class: 'row'}, ...children);
    this.body.append(row);
    return row;
  }

  slider({label, value, least = 0, greatest = 1, step = (greatest - least) / 500, show = String, changed, done}) {
    const id = `c${++count}`;
    const input = element('input', {type: 'range', id, min: least, max: greatest, step});
    const reading = element('output', {for: id});
    const present = v => {
      input.value = v;
      reading.textContent = show(Number(v));
      input.setAttribute('aria-valuetext', reading.textContent);
      input.style.setProperty('--share', (input.value - input.min) / (input.max - input.min || 1));
    };
    input.addEventListener('input', () => {
      const v = Number(input.value);
      changed(v);
      present(v);  // last: what is told of a value may depend on what changed
    });
    if (done) input.addEventListener('change', () => done(Number(input.value)));
    const row = this.row(element('label', {for: id}, label), reading, input);
    row.classList.add('slider');
    present(value);
    return {element: row, input, set: present, range(a, b, step = (b - a) / 500) {
      [input.min, input.max, input.step] = [a, b, step];
    }};
  }

  toggle({label, value, changed, key}) {
    const id = `c${++count}`, input = element('input', {type: 'checkbox', role: 'switch', id});
    input.checked = value;
    input.addEventListener('change', () => changed(input.checked));
    const row = this.row(element('label', {for: id}, label), ...(key ? [element('kbd', {'aria-hidden': 'true'}, key)] : []), input);
    row.classList.add('toggle');
    return {element: row, input, set: v => { input.checked = v; }};
  }

  /// Numbers that are typed: `values` are what is shown.
  numbers({label, names, values, changed}) {
    const inputs = values.map((value, n) => element('input', {type: 'text', inputmode: 'decimal', value, 'aria-label': names[n]}));
    let shown = values;
    const set = v => { shown = v; v.forEach((text, n) => { if (document.activeElement !== inputs[n]) inputs[n].value = text; }); };
    const given = () => inputs.map(input => Number(input.value.replace('−', '-').trim() || NaN));
    for (const input of inputs)
      input.addEventListener('change', () => {
        if (given().every(Number.isFinite)) changed(given());
        else inputs.forEach((one, n) => { one.value = shown[n]; });
      });
    const row = this.row(element('span', {class: 'label', 'aria-hidden': 'true'}, label), element('span', {class: 'numbers'}, ...inputs));
    return {element: row, inputs, set};
  }

  /// A colour and a switch: of one thing in a list.
  item({label, color, value, colored, changed}) {
    const id = `c${++count}`, picker = element('input', {type: 'color', value: color, 'aria-label': `colour of ${label}`});
    const input = element('input', {type: 'checkbox', role: 'switch', id});
    input.checked = value;
    picker.addEventListener('input', () => colored(picker.value));
    input.addEventListener('change', () => changed(input.checked));
    const row = this.row(picker, element('label', {for: id}, label), input);
    row.classList.add('item');
    return {element: row, input, picker, set: v => { input.checked = v; }};
  }

  /// `options`: [value, text] pairs, of which one is chosen.
  choice({label, value, options, changed}) {
    const name = `c${++count}`, inputs = new Map();
    const group = element('div', {class: 'choice', role: 'radiogroup', 'aria-label': label});
    for (const [key, text] of options) {
      const id = `${name}-${key}`, input = element('input', {type: 'radio', name, id, value: key});
      input.addEventListener('change', () => changed(key));
      inputs.set(key, input);
      group.append(input, element('label', {for: id}, text));
    }
    const row = this.row(element('span', {class: 'label', 'aria-hidden': 'true'}, label), group);
    row.classList.add('choices');
    const set = v => { if (inputs.has(v)) inputs.get(v).checked = true; };
    set(value);
    return {element: row, set};
  }

  button(label, pressed) {
    const made = element('button', {type: 'button', class: 'button', click: pressed}, label);
    this.row(made).classList.add('buttons');
    return {element: made, set: text => { made.textContent = text; }};
  }

  /// Lines of a name and a text; `set([[name, text], ..])`.
  facts(list = []) {
    const made = element('dl', {class: 'facts'});
    this.body.append(made);
    const set = rows => made.replaceChildren(...rows.flatMap(([name, text]) => [element('dt', {}, name), element('dd', {}, text)]));
    set(list);
    return {element: made, set};
  }
}
