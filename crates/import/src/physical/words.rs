//! Words of a closed set, for messages.

/// Longest word for which a near one is looked up: the distance takes time in its square, and nobody mistypes more.
const LONGEST: usize = 40;

/// Most known words that are looked at.
const MOST: usize = 1000;

/// Words of other programs, with ours: of several the first that is known where the word stands.
const ALIASES: [(&str, &[&str]); 81] = [
    // Materials.
    ("glass", &["dielectric"]),
    ("thin-dielectric", &["dielectric"]),
    ("rough-dielectric", &["dielectric"]),
    ("water", &["dielectric"]),
    ("diffuse", &["lambert", "albedo"]),
    ("matte", &["lambert"]),
    ("matt", &["lambert"]),
    ("lambertian", &["lambert"]),
    ("metal", &["conductor"]),
    ("metallic", &["conductor"]),
    ("rough-conductor", &["conductor"]),
    ("coated-diffuse", &["plastic"]),
    ("coated", &["plastic"]),
    ("rough-plastic", &["plastic"]),
    ("glossy", &["plastic", "phong"]),
    ("principled", &["plastic"]),
    ("uber", &["plastic"]),
    ("blinn", &["phong"]),
    ("specular", &["mirror"]),
    ("blend", &["mix"]),
    ("mixture", &["mix"]),
    ("base-color", &["albedo", "diffuse", "reflectance"]),
    ("color", &["albedo", "diffuse", "reflectance", "radiance", "intensity", "irradiance"]),
    ("colour", &["albedo", "diffuse", "reflectance", "radiance", "intensity", "irradiance"]),
    ("kd", &["albedo", "diffuse"]),
    ("ks", &["specular"]),
    ("shininess", &["exponent"]),
    ("eta", &["ior"]),
    ("int-ior", &["ior"]),
    ("index", &["ior"]),
    ("alpha-x", &["roughness"]),
    ("amount", &["weight"]),
    ("emit", &["emission"]),
    ("emissive", &["emission"]),
    ("bump", &["normal-map"]),
    ("opacity", &["alpha"]),
    ("mask", &["alpha"]),
    // Lights.
    ("sun", &["directional"]),
    ("distant", &["directional"]),
    ("parallel", &["directional"]),
    ("area", &["rectangle"]),
    ("quad", &["rectangle"]),
    ("square", &["rectangle"]),
    ("plane", &["rectangle"]),
    ("disk", &["rectangle", "sphere"]),
    ("omni", &["point"]),
    ("spotlight", &["spot"]),
    ("env", &["environment"]),
    ("envmap", &["environment"]),
    ("sky", &["environment"]),
    ("infinite", &["environment"]),
    ("world", &["environment"]),
    ("background", &["environment"]),
    ("strength", &["power", "radiance", "intensity", "irradiance"]),
    ("cutoff-angle", &["outer"]),
    // Objects.
    ("cube", &["box"]),
    ("shape", &["object"]),
    ("primitive", &["object"]),
    ("model", &["mesh", "file"]),
    ("filename", &["file", "image"]),
    ("path", &["file", "image"]),
    ("texture", &["image"]),
    ("origin", &["position", "center"]),
    ("centre", &["center"]),
    ("translation", &["translate"]),
    ("rotation", &["rotate"]),
    // The camera.
    ("look-at", &["target"]),
    ("lookat", &["target"]),
    ("eye", &["position"]),
    ("aperture", &["lens-radius"]),
    ("aperture-radius", &["lens-radius"]),
    ("f-stop", &["lens-radius"]),
    ("focal-distance", &["focus-distance"]),
    ("focal-length", &["fov"]),
    ("field-of-view", &["fov"]),
    ("fovy", &["fov"]),
    ("yfov", &["fov"]),
    ("sensor", &["camera"]),
    ("emitter", &["light"]),
    ("lamp", &["light"]),
    ("bsdf", &["material"]),
];

/// The table of light from far away.
const ENVIRONMENT: &str = "environment";

/// `` `a`, `b` ``
pub(super) fn listed(words: &[&str]) -> String {
    quoted(words).join(", ")
}

/// `` `a` or `b` ``
pub(super) fn either(words: &[&str]) -> String {
    quoted(words).join(" or ")
}

fn quoted(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| format!("`{word}`")).collect()
}

/// `` : did you mean `albedo`? `` for `albdeo` or `diffuse`; nothing if no known word is near.
pub(super) fn did_you_mean(word: &str, known: &[&str]) -> String {
    if let Some(near) = alias(word, known).or_else(|| nearest(word, known)) {
        return format!(": did you mean `{near}`?");
    }
    // What other programs have among the lights or textures is a table here.
    let is_table = !known.contains(&ENVIRONMENT) && alias(word, &[ENVIRONMENT]).is_some();
    if is_table { format!(": did you mean the table `[{ENVIRONMENT}]`?") } else { String::new() }
}

/// The known word that means the same, in small letters and with hyphens or not.
fn alias<'w>(word: &str, known: &[&'w str]) -> Option<&'w str> {
    if word.len() > LONGEST {
        return None;
    }
    let plain = |word: &str| word.to_lowercase().replace(['-', '_', ' '], "");
    let word = plain(word);
    let same = known.iter().copied().take(MOST).find(|known| plain(known) == word);
    let ours = || ALIASES.iter().find(|(other, _)| plain(other) == word).map_or(&[][..], |(_, ours)| ours);
    same.or_else(|| ours().iter().find_map(|ours| known.iter().copied().find(|known| known == ours)))
}

fn nearest<'w>(word: &str, known: &[&'w str]) -> Option<&'w str> {
    if word.len() > LONGEST {
        return None;
    }
    let distance = |other: &str| strsim::damerau_levenshtein(word, other);
    let short = known.iter().copied().take(MOST).filter(|other| other.len() <= LONGEST);
    let near = short.min_by_key(|other| distance(other))?;
    (distance(near) <= near.len().max(word.len()) / 3).then_some(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_suggested_and_far_ones_not() {
        assert_eq!(nearest("albdeo", &["alpha", "albedo"]), Some("albedo"));
        assert_eq!(nearest("lihgt", &["light"]), Some("light"));
        assert_eq!(nearest("cam", &["name", "camera"]), None);
        assert_eq!(nearest("zebra", &["alpha", "albedo"]), None);
        assert_eq!(nearest(&"x".repeat(100), &["x"]), None);
    }

    #[test]
    fn words_of_other_programs_are_known_where_they_have_a_meaning() {
        assert_eq!(alias("glass", &["lambert", "dielectric"]), Some("dielectric"));
        assert_eq!(alias("Diffuse", &["name", "albedo"]), Some("albedo"));
        assert_eq!(alias("LENS_RADIUS", &["lens-radius"]), Some("lens-radius"));
        assert_eq!((alias("glass", &["albedo"]), alias("wax", &["lambert"])), (None, None));
        assert_eq!(did_you_mean("sky", &["point"]), ": did you mean the table `[environment]`?");
        assert_eq!(did_you_mean("sun", &["point", "directional"]), ": did you mean `directional`?");
    }
}
