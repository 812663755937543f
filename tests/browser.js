// What a person could not read on this page: a list of places for each kind of flaw.
() => {
  const LEAST_SIZE = 11.9, LEAST_CONTRAST = 4.5, SLACK = 1.5
  const flaws = { 'page scrolls sideways': [], 'small text': [], 'low contrast': [],
                  'cut off': [], 'overlap': [] }
  const name = (e) => `<${e.tagName.toLowerCase()} class="${e.getAttribute('class') || ''}"> ` +
    JSON.stringify((e.textContent || '').trim().slice(0, 40))

  if (document.documentElement.scrollWidth > window.innerWidth) {
    flaws['page scrolls sideways'].push(`${document.documentElement.scrollWidth} px`)
  }

  // Elements with text of their own that is on the page.
  const withText = []
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT)
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement
    if (!walker.currentNode.data.trim() || element.closest('title, desc, style')) continue
    const range = document.createRange()
    range.selectNodeContents(walker.currentNode)
    const box = range.getBoundingClientRect()
    const lines = [...range.getClientRects()]
    if (box.width > 0 && element.checkVisibility()) withText.push({ element, box, lines })
  }

  const scale = (e) => e.closest('svg') ? Math.hypot(e.getScreenCTM().a, e.getScreenCTM().b) : 1
  const rgb = (colour) => (colour.match(/[\d.]+/g) || []).map(Number)
  const opaque = (c) => c.length >= 3 && (c.length < 4 || c[3] > 0.99)
  const light = (c) => {
    const [r, g, b] = c.slice(0, 3).map((v) => v / 255).map((v) =>
      v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b
  }
  const ground = (e) => {
    const rect = e.closest('g')?.querySelector(':scope > rect')
    if (rect) return rgb(getComputedStyle(rect).fill)
    for (let at = e; at; at = at.parentElement) {
      const colour = rgb(getComputedStyle(at).backgroundColor)
      if (opaque(colour)) return colour
    }
    return [255, 255, 255]
  }

  for (const { element } of withText) {
    const style = getComputedStyle(element)
    const size = parseFloat(style.fontSize) * scale(element)
    if (size < LEAST_SIZE) flaws['small text'].push(`${size.toFixed(1)} px: ${name(element)}`)
    const ink = rgb(element.closest('svg') ? style.fill : style.color)
    const [low, high] = [light(ink), light(ground(element))].sort((a, b) => a - b)
    const contrast = (high + 0.05) / (low + 0.05)
    if (contrast < LEAST_CONTRAST) {
      flaws['low contrast'].push(`${contrast.toFixed(2)}: ${name(element)}`)
    }
  }

  // Text that goes past its drawing, or past the page where nothing lets it scroll.
  for (const { element, box } of withText) {
    const svg = element.closest('svg')
    if (svg) {
      const frame = svg.getBoundingClientRect()
      if (box.left < frame.left - SLACK || box.right > frame.right + SLACK ||
          box.top < frame.top - SLACK || box.bottom > frame.bottom + SLACK) {
        flaws['cut off'].push(name(element))
      }
    } else if (!element.closest('.scroll') && (box.left < -SLACK || box.right > window.innerWidth + SLACK)) {
      flaws['cut off'].push(name(element))
    }
  }
  for (const e of document.querySelectorAll('.badge, .chip, .figure, .tag, h1, h2, h3, .rule p')) {
    if (e.scrollWidth > e.clientWidth + SLACK && e.clientWidth > 0) flaws['cut off'].push(name(e))
  }

  // Text on text.
  const overlap = (a, b) =>
    Math.min(a.right, b.right) - Math.max(a.left, b.left) > 2 &&
    Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 4
  const groups = new Map()
  for (const item of withText) {
    const group = item.element.closest('svg, .rule, .tiles, .facts, tr, h1, h2, h3')
    if (group) groups.set(group, [...(groups.get(group) || []), item])
  }
  const stuck = (e) => e.closest('th[scope=row]')   // stays while its row scrolls beneath it
  for (const items of groups.values()) {
    items.forEach((a, i) => items.slice(i + 1).forEach((b) => {
      if (a.element !== b.element && !stuck(a.element) && !stuck(b.element) &&
          a.lines.some((line) => b.lines.some((other) => overlap(line, other)))) {
        flaws['overlap'].push(`${name(a.element)} and ${name(b.element)}`)
      }
    }))
  }
  return flaws
}
