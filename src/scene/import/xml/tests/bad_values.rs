//! Values and transforms that cannot be read, and what is said about each.

use super::check;

/// A value of a BSDF, which stands in the third line of its file, and below it what is said.
const BAD_VALUES: &str = r##"
<float name='a' value='1.5x'/>
    t.xml:3:24: found "1.5x", expected a number
<float name='a' value='nan'/>
    t.xml:3:24: found "nan", expected a number
<integer name='a' value='1.5'/>
    t.xml:3:26: found "1.5", expected an integer
<boolean name='a' value='yes'/>
    t.xml:3:26: found "yes", expected true or false
<point name='a' value='1 2 3 4'/>
    t.xml:3:24: found 4 numbers in "1 2 3 4", expected 2 or 3
<point name='a'/>
    t.xml:3:1: <point> needs x, y and z, or a "value"
<rgb name='a' value='1 2'/>
    t.xml:3:22: found 2 numbers in "1 2", expected 3
<rgb name='a' value='#12345'/>
    t.xml:3:22: found "#12345", expected three numbers or "#rrggbb"
<rgb name='a' value='#ééé'/>
    t.xml:3:22: found "#ééé", expected three numbers or "#rrggbb"
<spectrum name='a' value='1 2'/>
    t.xml:3:27: found 2 numbers in "1 2", expected 1, 3, or pairs "wavelength:value"
<spectrum name='a' value='400:1 5'/>
    t.xml:3:27: found "5", expected "wavelength:value"
<spectrum name='a' value='500:1 400:2'/>
    t.xml:3:27: wavelengths must increase, but 400 nm follows 500 nm
<spectrum name='a' type='blackbdy'/>
    t.xml:3:26: unknown spectrum "blackbdy" (did you mean "blackbody"?)
<spectrum name='a' type='blackbody'/>
    t.xml:3:26: spectrum "blackbody" lacks a value
<blackbody name='a' temperature='-3'/>
    t.xml:3:1: found -3, expected a temperature above 0 kelvin
<float nmae='a' value='1'/>
    t.xml:3:1: <float> needs the attribute "name" (found "nmae")
<float name='a'/>
    t.xml:3:1: <float> needs the attribute "value"
<float name='a' value='1' unit='m'/>
    t.xml:3:33: warning: unknown attribute "unit" of <float>; ignored
<float name='a' value='1'><x/></float>
    t.xml:3:27: warning: <float> holds no <x>; ignored
"##;

/// The same for what is inside of a transform.
const BAD_TRANSFORMS: &str = r##"
<matrix value='1 2 3'/>
    t.xml:3:36: found 3 numbers in "1 2 3", expected 16 or 9
<matrix value='1 2 3 4 5 6 7 8 9'/>
    t.xml:3:21: <matrix>: the matrix is singular: it flattens space and has no inverse
<scale z='0'/>
    t.xml:3:21: <scale>: the matrix is singular: it flattens space and has no inverse
<rotate angle='3'/>
    t.xml:3:21: <rotate>: the axis of rotation is zero
<rotate x='1'/>
    t.xml:3:21: <rotate> needs the attribute "angle"
<lookat origin='1 1 1' target='1 1 1' up='0 1 0'/>
    t.xml:3:21: <lookat>: origin and target are the same point
<lookat origin='1 1 1' target='1 2 1' up='0 1 0'/>
    t.xml:3:21: <lookat>: the up vector is zero or parallel to the viewing direction
<lookat origin='1 1 1'/>
    t.xml:3:21: <lookat> needs the attribute "target"
<translte x='1'/>
    t.xml:3:21: warning: unknown element <translte> in a transform (did you mean "translate"?); ignored
"##;

/// Checks each entry of a table, its value written as `value` writes it.
fn check_table(table: &str, value: impl Fn(&str) -> String) {
    let lines: Vec<&str> = table.trim().lines().collect();
    assert_eq!(lines.len() % 2, 0);
    for entry in lines.chunks_exact(2) {
        let body = format!("<bsdf type='x'>\n{}</bsdf>", value(entry[0]));
        check(&body, &[entry[1].trim_start()]);
    }
}

#[test]
fn bad_values_say_what_was_found_and_what_was_expected() {
    check_table(BAD_VALUES, str::to_owned);
}

#[test]
fn bad_transforms_are_refused() {
    check_table(BAD_TRANSFORMS, |inner| {
        format!("<transform name='a'>{inner}</transform>")
    });
}
