//! Parses the comma-separated lists of numbers in flags.

use std::str::FromStr;

use glam::DVec3;

/// `N` points or directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Triple<const N: usize>(pub(super) [DVec3; N]);

fn parse(list: &str) -> Result<Vec<f64>, String> {
    let number = |(index, text): (usize, &str)| {
        let text = text.trim();
        text.parse().map_err(|_| format!("number {index} is \"{text}\""))
    };
    list.split(',').enumerate().map(number).collect()
}

impl<const N: usize> FromStr for Triple<N> {
    type Err = String;

    fn from_str(list: &str) -> Result<Self, String> {
        let numbers = parse(list)?;
        if numbers.len() != 3 * N {
            return Err(format!("expected {} numbers, found {}", 3 * N, numbers.len()));
        }
        Ok(Self(std::array::from_fn(|i| DVec3::from_slice(&numbers[3 * i..]))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_and_wrong_ones_explained() {
        let ray: Result<Triple<2>, _> = "1, -2,3e0,0,0,1".parse();
        assert_eq!(ray, Ok(Triple([DVec3::new(1.0, -2.0, 3.0), DVec3::Z])));
        assert_eq!("1,2".parse::<Triple<1>>(), Err("expected 3 numbers, found 2".into()));
        assert_eq!("1,x,3".parse::<Triple<1>>(), Err("number 1 is \"x\"".into()));
        assert_eq!("".parse::<Triple<1>>(), Err("number 0 is \"\"".into()));
    }
}
