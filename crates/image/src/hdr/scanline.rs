//! The pixels of a scan line: plain, or with run lengths of the old or the new kind.

/// Lengths of scan lines that can have run lengths of the new kind.
const NEW_LENGTHS: std::ops::RangeInclusive<usize> = 8..=0x7fff;
/// A count above this says how often one byte is repeated, beyond this.
const RUN: u8 = 128;
/// Bits by which each of several run lengths of the old kind in a row is worth more than the one before.
const OLD_SHIFT: u32 = 8;

/// Reads a scan line that fills `line`, moving `bytes` past it. Fails where the bytes end or a run is longer than the line.
pub(super) fn read_scanline(bytes: &mut &[u8], line: &mut [[u8; 4]]) -> Result<(), String> {
    if let [2, 2, high @ 0..RUN, low, ..] = **bytes
        && NEW_LENGTHS.contains(&line.len())
    {
        let length = (usize::from(high) << 8) | usize::from(low);
        if length != line.len() {
            return Err(format!("it has {length} pixels, but the picture has {}", line.len()));
        }
        *bytes = &bytes[4..];
        return (0..4).try_for_each(|component| read_component(bytes, line, component));
    }
    read_pixels(bytes, line)
}

/// One component of all pixels, in runs and literal bytes.
fn read_component(bytes: &mut &[u8], line: &mut [[u8; 4]], component: usize) -> Result<(), String> {
    let mut at = 0;
    while at < line.len() {
        let count = take::<1>(bytes)?[0];
        let is_run = count > RUN;
        let length = usize::from(if is_run { count - RUN } else { count });
        let places = line.get_mut(at..at + length).ok_or("a run is longer than the line")?;
        at += length;
        if is_run {
            let [value] = take::<1>(bytes)?;
            for pixel in places {
                pixel[component] = value;
            }
        } else {
            let (values, rest) = bytes.split_at_checked(length).ok_or_else(ended)?;
            *bytes = rest;
            places.iter_mut().zip(values).for_each(|(pixel, value)| pixel[component] = *value);
        }
    }
    Ok(())
}

/// Pixel by pixel; one of three ones repeats the pixel before it.
fn read_pixels(bytes: &mut &[u8], line: &mut [[u8; 4]]) -> Result<(), String> {
    let (mut at, mut shift) = (0, 0);
    while at < line.len() {
        let pixel = take::<4>(bytes)?;
        let [1, 1, 1, count] = pixel else {
            line[at] = pixel;
            (at, shift) = (at + 1, 0);
            continue;
        };
        let before = *at.checked_sub(1).and_then(|before| line.get(before)).ok_or("a run has no pixel before it")?;
        // What does not fit the line is an error, whatever it would be.
        let length = u64::from(count).checked_shl(shift).unwrap_or(u64::MAX);
        let places = usize::try_from(length).ok().and_then(|length| line.get_mut(at..at.checked_add(length)?));
        let places = places.ok_or("a run is longer than the line")?;
        places.fill(before);
        at += places.len();
        shift = (shift + OLD_SHIFT).min(u64::BITS - OLD_SHIFT);
    }
    Ok(())
}

fn take<const N: usize>(bytes: &mut &[u8]) -> Result<[u8; N], String> {
    let (taken, rest) = bytes.split_first_chunk::<N>().ok_or_else(ended)?;
    *bytes = rest;
    Ok(*taken)
}

fn ended() -> String {
    "the file ends too early".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXEL: [u8; 4] = [128, 64, 0, 129];

    fn read(length: usize, bytes: &[u8]) -> Result<(Vec<[u8; 4]>, usize), String> {
        let (mut rest, mut line) = (bytes, vec![[0; 4]; length]);
        read_scanline(&mut rest, &mut line).map(|()| (line, rest.len()))
    }

    #[test]
    fn runs_of_both_kinds_and_plain_pixels_are_read() {
        assert_eq!(read(2, &[PIXEL, [2, 2, 0, 2]].concat()), Ok((vec![PIXEL, [2, 2, 0, 2]], 0)));
        assert_eq!(read(9, &[PIXEL, [1, 1, 1, 8], PIXEL].concat()), Ok((vec![PIXEL; 9], 4)));
        // Two in a row: 44 + 256 pixels more.
        assert_eq!(read(301, &[PIXEL, [1, 1, 1, 44], [1, 1, 1, 1]].concat()), Ok((vec![PIXEL; 301], 0)));
        // The shift ends with the row of runs.
        let bytes = [PIXEL, [1, 1, 1, 3], [9; 4], [1, 1, 1, 2]].concat();
        assert_eq!(read(7, &bytes), Ok(([vec![PIXEL; 4], vec![[9; 4]; 3]].concat(), 0)));
        let runs = [2, 2, 0, 8, 136, 128, 136, 64, 136, 0, 136, 129];
        assert_eq!(read(8, &runs), Ok((vec![PIXEL; 8], 0)));
        let mixed = [&[2, 2, 0, 8, 3, 7, 8, 9, 133, 5][..], &[136, 0, 136, 0, 136, 0]].concat();
        let expected: Vec<[u8; 4]> = [7, 8, 9, 5, 5, 5, 5, 5].map(|red| [red, 0, 0, 0]).to_vec();
        assert_eq!(read(8, &mixed), Ok((expected, 0)));
    }

    #[test]
    fn what_does_not_fit_is_an_error() {
        let refused = |length, bytes: &[u8], expected: &str| assert_eq!(read(length, bytes).unwrap_err(), expected);
        refused(2, &PIXEL, "the file ends too early");
        refused(2, &[1, 1, 1, 1], "a run has no pixel before it");
        refused(4, &[PIXEL, [1, 1, 1, 4]].concat(), "a run is longer than the line");
        refused(8, &[2, 2, 0, 9, 0], "it has 9 pixels, but the picture has 8");
        refused(8, &[2, 2, 0, 8, 137, 1], "a run is longer than the line");
        refused(8, &[2, 2, 0, 8, 4, 1, 2], "the file ends too early");
        refused(8, &[2, 2, 0, 8, 136], "the file ends too early");
    }
}
