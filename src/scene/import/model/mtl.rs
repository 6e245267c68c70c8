//! Material libraries of Wavefront OBJ (MTL).

use crate::math::{Rgb, Vec2};

/// A material as its library writes it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Material {
    pub(super) name: String,
    /// Line that begins it, from 1.
    pub(super) line: usize,
    /// `Kd`, `Ks`, `Ke`: diffuse and specular reflectance, radiance.
    pub(super) diffuse: Option<Rgb>,
    pub(super) specular: Rgb,
    pub(super) emission: Rgb,
    /// `Ns`: exponent of the highlight.
    pub(super) exponent: f32,
    /// `Ni`: index of refraction.
    pub(super) ior: Option<f32>,
    /// `d`, or one minus `Tr`: opacity.
    pub(super) opacity: f32,
    /// `Tf`: what goes through.
    pub(super) transmission: Rgb,
    /// `illum`: the model of illumination, 0 to 10.
    pub(super) model: i32,
    /// `Pr` and `Pm`, the roughness and the metal of later programs.
    pub(super) roughness: Option<f32>,
    pub(super) metallic: Option<f32>,
    /// `map_Kd`, `map_Ks`, `map_Ke`, `map_d`, `map_bump` (or `bump`), `norm`.
    pub(super) maps: Vec<Map>,
}

/// What a picture gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MapKind {
    Diffuse,
    Specular,
    Emission,
    Opacity,
    Bump,
    Normal,
}

/// A picture with its options.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    pub(super) kind: MapKind,
    pub(super) line: usize,
    pub(super) file: String,
    /// `-o` and `-s`: what coordinates are moved and multiplied by.
    pub(super) offset: Vec2,
    pub(super) scale: Vec2,
    /// `-clamp on`.
    pub(super) clamp: bool,
    /// `-bm`: how high bumps are.
    pub(super) height: f32,
}

/// Something that is not read, out of range or broken: where, and what is wrong with it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Complaint {
    /// From 1, as `column`.
    pub(super) line: usize,
    pub(super) column: usize,
    pub(super) message: String,
    pub(super) is_error: bool,
}

/// Statements that say nothing about the picture, or what is drawn in another way.
const IGNORED: [&str; 4] = ["Ka", "map_Ka", "sharpness", "map_aat"];

/// Parses a library.
///
/// Broken statements are complained of, and the rest is read; numbers out of range are clamped.
pub(super) fn parse(bytes: &[u8]) -> (Vec<Material>, Vec<Complaint>) {
    let text = String::from_utf8_lossy(bytes);
    let (mut materials, mut complaints) = (Vec::<Material>::new(), Vec::new());
    for (index, text) in text.lines().enumerate() {
        let line = index + 1;
        let said = text.split('#').next().unwrap_or_default().trim();
        let (keyword, rest) = said.split_once(char::is_whitespace).unwrap_or((said, ""));
        let statement = Statement {
            text,
            line,
            keyword,
            rest: rest.trim_start(),
        };
        let result = match (keyword, materials.last_mut()) {
            ("", _) => Ok(()),
            ("newmtl", _) => {
                materials.push(Material::new(statement.rest.to_owned(), line));
                Ok(())
            }
            (_, Some(material)) => material.take(&statement, &mut complaints),
            _ => {
                let message = format!("\"{keyword}\" before the first newmtl");
                Err(statement.broken(keyword, message))
            }
        };
        complaints.extend(result.err());
    }
    (materials, complaints)
}

impl Material {
    fn new(name: String, line: usize) -> Self {
        Self {
            name,
            line,
            diffuse: None,
            specular: Rgb::BLACK,
            emission: Rgb::BLACK,
            exponent: 0.0,
            ior: None,
            opacity: 1.0,
            transmission: Rgb::WHITE,
            model: 2,
            roughness: None,
            metallic: None,
            maps: Vec::new(),
        }
    }

    /// The last picture of a kind.
    pub(super) fn map(&self, kind: MapKind) -> Option<&Map> {
        self.maps.iter().rev().find(|map| map.kind == kind)
    }

    /// Takes over what a statement says.
    ///
    /// - `complaints`: takes numbers that are clamped.
    fn take(
        &mut self,
        statement: &Statement<'_>,
        complaints: &mut Vec<Complaint>,
    ) -> Result<(), Complaint> {
        let mut colour = |most| statement.colour(most, complaints);
        match statement.keyword {
            "Kd" => self.diffuse = Some(colour(1.0)?),
            "Ks" => self.specular = colour(1.0)?,
            "Ke" => self.emission = colour(f32::INFINITY)?,
            "Tf" => self.transmission = colour(1.0)?,
            "Ns" => self.exponent = statement.number(f32::INFINITY, complaints)?,
            "Ni" => self.ior = Some(statement.any_number(statement.rest)?),
            "d" => self.opacity = statement.number(1.0, complaints)?,
            "Tr" => self.opacity = 1.0 - statement.number(1.0, complaints)?,
            "Pr" => self.roughness = Some(statement.number(1.0, complaints)?),
            "Pm" => self.metallic = Some(statement.number(1.0, complaints)?),
            "illum" => self.model = statement.any_number(statement.rest)? as i32,
            keyword if IGNORED.contains(&keyword) => {}
            keyword => match map_kind(keyword) {
                Some(kind) => self.maps.push(statement.map(kind)?),
                None => {
                    let message = format!("\"{keyword}\" is not read; ignored");
                    return Err(statement.complaint(keyword, message, false));
                }
            },
        }
        Ok(())
    }
}

fn map_kind(keyword: &str) -> Option<MapKind> {
    match keyword.to_lowercase().as_str() {
        "map_kd" => Some(MapKind::Diffuse),
        "map_ks" => Some(MapKind::Specular),
        "map_ke" => Some(MapKind::Emission),
        "map_d" => Some(MapKind::Opacity),
        "map_bump" | "bump" => Some(MapKind::Bump),
        "norm" | "map_kn" => Some(MapKind::Normal),
        _ => None,
    }
}

/// A line that says something.
struct Statement<'t> {
    /// All of the line; the other parts stand in it.
    text: &'t str,
    /// Its number, from 1.
    line: usize,
    keyword: &'t str,
    rest: &'t str,
}

impl<'t> Statement<'t> {
    /// - `at`: a part of the line.
    fn complaint(&self, at: &str, message: String, is_error: bool) -> Complaint {
        let before = (at.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        let before = self.text.get(..before).unwrap_or_default();
        Complaint {
            line: self.line,
            column: before.chars().count() + 1,
            message,
            is_error,
        }
    }

    fn broken(&self, at: &str, message: String) -> Complaint {
        self.complaint(at, message, true)
    }

    fn any_number(&self, text: &str) -> Result<f32, Complaint> {
        let value = word(text).0.parse::<f32>().ok();
        let value = value.filter(|value| value.is_finite());
        let keyword = self.keyword;
        let message = || format!("{keyword} is \"{text}\", expected a number");
        value.ok_or_else(|| self.broken(text, message()))
    }

    /// A number from 0 to `most`; others are clamped.
    fn number(&self, most: f32, complaints: &mut Vec<Complaint>) -> Result<f32, Complaint> {
        let text = match self.keyword {
            "d" => self.rest.trim_start_matches("-halo").trim_start(),
            _ => self.rest,
        };
        let value = self.any_number(text)?;
        let clamped = value.clamp(0.0, most);
        if clamped != value {
            complaints.push(self.clamped(text, &value.to_string(), most));
        }
        Ok(clamped)
    }

    /// One number for grey, or three, from 0 to `most`; others are clamped.
    fn colour(&self, most: f32, complaints: &mut Vec<Complaint>) -> Result<Rgb, Complaint> {
        let (keyword, text) = (self.keyword, self.rest);
        let (values, rest) = numbers(text);
        let colour = match values[..] {
            [grey] => Some(Rgb::grey(grey)),
            [r, g, b] => Some(Rgb::new(r, g, b)),
            _ => None,
        };
        let colour = colour.filter(|colour| rest.is_empty() && colour.0.is_finite());
        let message = || format!("{keyword} is \"{text}\", expected one number or three");
        let colour = colour.ok_or_else(|| self.broken(text, message()))?;
        let clamped = colour.clamp(0.0, most);
        if clamped != colour {
            complaints.push(self.clamped(text, text, most));
        }
        Ok(clamped)
    }

    fn clamped(&self, at: &str, value: &str, most: f32) -> Complaint {
        let keyword = self.keyword;
        let message = format!("{keyword} is {value}, {}; clamped", super::range(most));
        self.complaint(at, message, false)
    }

    /// Reads options, then the rest of the line as a name, blanks included.
    fn map(&self, kind: MapKind) -> Result<Map, Complaint> {
        let (keyword, line) = (self.keyword, self.line);
        let mut map = Map {
            kind,
            line,
            file: String::new(),
            offset: Vec2::ZERO,
            scale: Vec2::ONE,
            clamp: false,
            height: 1.0,
        };
        let mut rest: &'t str = self.rest;
        while rest.starts_with('-') {
            let (option, after) = word(rest);
            rest = match option {
                "-o" | "-s" | "-t" => {
                    let (values, after) = numbers(after);
                    let of = |index: usize, default: f32| *values.get(index).unwrap_or(&default);
                    match option {
                        "-o" => map.offset = Vec2::new(of(0, 0.0), of(1, 0.0)),
                        "-s" => map.scale = Vec2::new(of(0, 1.0), of(1, 1.0)),
                        _ => {}
                    }
                    after
                }
                "-bm" => {
                    map.height = self.any_number(after)?;
                    word(after).1
                }
                "-clamp" => {
                    map.clamp = word(after).0 == "on";
                    word(after).1
                }
                "-mm" => word(word(after).1).1,
                "-boost" | "-texres" | "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-type" => {
                    word(after).1
                }
                _ => {
                    let message = format!("{keyword}: unknown option \"{option}\"");
                    return Err(self.broken(rest, message));
                }
            };
        }
        if rest.is_empty() {
            return Err(self.broken(keyword, format!("{keyword} names no file")));
        }
        rest.clone_into(&mut map.file);
        Ok(map)
    }
}

/// The first word, and what follows it.
fn word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

/// Up to three numbers, and what follows them.
fn numbers(text: &str) -> (Vec<f32>, &str) {
    let (mut values, mut rest) = (Vec::new(), text);
    while values.len() < 3 {
        let (first, after) = word(rest);
        let Ok(value) = first.parse::<f32>() else {
            break;
        };
        values.push(value);
        rest = after;
    }
    (values, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_are_read_with_their_options() {
        let text = "# a library\nnewmtl red wall\nKd 0.5 0.1 0.1\nKs 0.2\nNs 96 # shiny\nNi 1.5\n\
                    d 0.25\nillum 2\nmap_Kd -s 2 3 1 -o 0.5 -clamp on a picture.png\n\
                    map_Bump -bm 0.02 b.png\n\nnewmtl lamp\nKe 5 5 5\nTr 0.25\nPr 0.3\n";
        let (materials, complaints) = parse(text.as_bytes());
        assert_eq!(complaints, []);
        let [red, lamp] = &materials[..] else {
            panic!("{materials:?}");
        };
        assert_eq!((red.name.as_str(), red.line), ("red wall", 2));
        assert_eq!(red.diffuse, Some(Rgb::new(0.5, 0.1, 0.1)));
        assert_eq!((red.specular, red.exponent), (Rgb::grey(0.2), 96.0));
        assert_eq!((red.ior, red.opacity), (Some(1.5), 0.25));
        let map = red.map(MapKind::Diffuse).unwrap();
        assert_eq!((map.file.as_str(), map.clamp), ("a picture.png", true));
        assert_eq!(
            (map.scale, map.offset),
            (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0))
        );
        assert_eq!(red.map(MapKind::Bump).unwrap().height, 0.02);
        assert_eq!((lamp.emission, lamp.opacity), (Rgb::grey(5.0), 0.75));
        assert_eq!(lamp.roughness, Some(0.3));
    }

    #[test]
    fn what_is_broken_or_out_of_range_is_told_with_its_place() {
        let text = "Kd 1 1 1\nnewmtl a\n  Kd 1 2\nNs x\nmap_Kd\nmap_Kd -s 1 -q 1 a.png\nrefl a.png\n\
                    Kd 2 0.5 -1\n\td -halo 1.5 # gone\nKe 7 7 -2\nNs -3\nPr 0.5\nTr -1\n";
        let (materials, complaints) = parse(text.as_bytes());
        let said = complaints.iter();
        let said = said.map(|c| format!("{}:{}: {} {}", c.line, c.column, c.message, c.is_error));
        let expected = [
            "1:1: \"Kd\" before the first newmtl true",
            "3:6: Kd is \"1 2\", expected one number or three true",
            "4:4: Ns is \"x\", expected a number true",
            "5:1: map_Kd names no file true",
            "6:13: map_Kd: unknown option \"-q\" true",
            "7:1: \"refl\" is not read; ignored false",
            "8:4: Kd is 2 0.5 -1, which is outside 0 to 1; clamped false",
            "9:10: d is 1.5, which is outside 0 to 1; clamped false",
            "10:4: Ke is 7 7 -2, which is negative; clamped false",
            "11:4: Ns is -3, which is negative; clamped false",
            "13:4: Tr is -1, which is outside 0 to 1; clamped false",
        ];
        assert_eq!(said.collect::<Vec<_>>(), expected);
        let [a] = &materials[..] else {
            panic!("{materials:?}");
        };
        assert_eq!(a.diffuse, Some(Rgb::new(1.0, 0.5, 0.0)));
        assert_eq!((a.emission, a.exponent), (Rgb::new(7.0, 7.0, 0.0), 0.0));
        assert_eq!((a.roughness, a.opacity), (Some(0.5), 1.0));
    }
}
