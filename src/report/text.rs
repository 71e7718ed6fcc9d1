//! The texts of a report: CSV, JSON and Markdown.

use super::baked_cache::BakeCost;
use super::bias::ORACLE_PATHS;
use super::error::ReportError;
use super::findings::Report;
use super::flicker::PATHS;
use super::measure::Measurement;
use super::pictures::strip_of;
use crate::text::visible;
use std::fmt::Write;
use std::io;

/// A row for each technique, with a header.
pub(super) fn csv(report: &Report) -> String {
    let mut text = "curve,flags,width,height,seconds,cpu_seconds,bake_seconds,full_size_seconds,rays,\
                    rays_per_second,rmse,relMSE,relMSE_low,relMSE_high,own_relMSE,p95_relative_error,\
                    mean_bias,mean_bias_low,mean_bias_high,flip\n"
        .to_owned();
    for m in &report.measurements {
        let numbers = [
            m.seconds,
            m.cpu_seconds,
            m.bake_seconds,
            m.full_size_seconds,
            m.rays,
            m.rays_per_second,
            m.rmse,
            m.rel_mse,
            m.spread[0],
            m.spread[1],
        ];
        let rest = [
            m.p95_relative_error,
            m.mean_bias,
            m.mean_bias_interval[0],
            m.mean_bias_interval[1],
            m.flip,
        ];
        let list = |numbers: &[f64]| {
            let numbers: Vec<String> = numbers.iter().map(|n| format!("{n:.6e}")).collect();
            numbers.join(",")
        };
        let own = format!("{:.6e}", m.own_estimate);
        let (width, height) = m.size;
        text += &format!(
            "\"{}\",\"{}\",{width},{height},{},{own},{}\n",
            m.curve,
            m.flags,
            list(&numbers),
            list(&rest)
        );
    }
    text
}

/// The whole report as JSON.
pub(super) fn json(report: &Report) -> Result<Vec<u8>, ReportError> {
    let json = serde_json::to_vec_pretty(report);
    json.map_err(|error| ReportError::Encoding(io::Error::other(error)))
}

/// A text that is shown as it is, whatever characters of Markdown or HTML it has.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for letter in visible(text).chars() {
        if letter.is_ascii_punctuation() && !matches!(letter, '-' | '.' | ',' | ':') {
            plain.push('\\');
        }
        plain.push(letter);
    }
    plain
}

/// The report as Markdown, with its pictures.
pub(super) fn markdown(report: &Report) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(report, &mut text);
    text
}

fn write(report: &Report, out: &mut String) -> std::fmt::Result {
    let (width, height) = report.full_size;
    writeln!(out, "# {}: error against time\n", plain(&report.title))?;
    for line in &report.advice {
        writeln!(out, "* {line}")?;
    }
    let frames: Vec<String> = report.frames.iter().map(u32::to_string).collect();
    writeln!(
        out,
        "\n![Error against time](curves.png)\n\n\
         Means of frames {} with {} seeds each, on {} threads, without a rendering to warm up. Advice and curves have \
         the seconds of a frame of {width}x{height}, in proportion to its pixels; where the irradiance cache is used, \
         with its part of baking, if all frames are rendered. Adaptive frames \
         check their own error, which takes a larger part of a small frame: at the sequence's own size they take less than \
         this says. Errors are in units of display white.\n\n\
         * relMSE: the mean of (x - r)^2 / (m^2 + 0.01), where r is the reference and m its local mean. It is corrected \
         for the noise of the reference, and may be negative where it is less than that; in brackets the least and the \
         largest of a seed.\n\
         * own relMSE: the estimate of the frames themselves, without a reference, and in brackets its part of the \
         measured one.{}\n\
         * p95 error: the 95th percentile of the relative errors.\n\
         * mean bias: with its 95 % confidence interval in brackets.\n\
         * FLIP: how visible the errors are when picture and reference alternate (Andersson et al. 2020).\n\n\
         {}\n",
        frames.join(", "),
        report.seeds,
        rayon::current_num_threads(),
        claims(&report.measurements),
        bake(&report.bake)
    )?;
    measurements(&report.measurements, report.full_size, out)?;
    writeln!(
        out,
        "\n| reference | frame | relMSE of the reference |\n|---|---|---|"
    )?;
    for reference in &report.references {
        let (width, height) = reference.size;
        let (frame, error) = (reference.frame, reference.rel_mse);
        writeln!(out, "| {width}x{height} | {frame} | {error:.1e} |")?;
    }
    writeln!(
        out,
        "\n## Bias\n\n\
         At random pixels, from two independent pictures and two independent oracle estimates of {ORACLE_PATHS} paths \
         each, with standard errors: the squared bias, the part of relMSE that averaging does not remove, and the mean \
         bias. Both pictures share the irradiance cache, so its error is part of the bias. relMSE includes bias as any other \
         error: a biased technique whose relMSE is below a target is as good as an unbiased one, but more samples do not \
         take it much further. An unbiased technique is called biased about once in 500 times; more often where a few bright pixels are among many dark ones.\n\n\
         | technique | pixels | squared bias | mean bias, % | |\n|---|---|---|---|---|"
    )?;
    for row in &report.bias {
        let (squared, mean) = (row.squared_bias, row.mean_bias / 0.01);
        let (width, height) = row.size;
        let verdict = if row.is_biased {
            "biased: part of its relMSE"
        } else {
            "none found"
        };
        writeln!(
            out,
            "| {}: `{}` | {} of {width}x{height} | {:.1e} ± {:.1e} | {:+.2} ± {:.2} | {verdict} |",
            row.curve, row.flags, row.pixels, squared.mean, squared.error, mean.mean, mean.error
        )?;
    }
    writeln!(
        out,
        "\n## Flicker\n\n\
         The root mean square change of the radiance, relative to it, from a frame of {width}x{height} to the next at \
         the same point of the scene, beyond the change of the references; with {PATHS} camera samples in each pixel, of one \
         path each where light is path-traced. Direct light alone, relative to all light, is what is left when indirect \
         light does not flicker.\n\n\
         ![Flicker](flicker.png)\n\n\
         | frame | kind | relative change | its square | pixels matched, % |\n|---|---|---|---|---|"
    )?;
    for row in &report.flicker {
        writeln!(
            out,
            "| {} | {} | {:.3} | {:.1e} ± {:.1e} | {:.0} |",
            row.frame,
            row.kind,
            row.relative,
            row.square.mean,
            row.square.error,
            100.0 * row.matched
        )?;
    }
    writeln!(
        out,
        "\n## Pictures\n\n\
         The last technique of each curve, and its relative error: black is 1 % or less, violet 10 %, pale yellow 100 % or more.\n"
    )?;
    let mut curves: Vec<&str> = report.measurements.iter().map(|m| m.curve).collect();
    curves.dedup();
    for curve in curves {
        writeln!(out, "{curve}\n\n![{curve}](strips/{})\n", strip_of(curve))?;
    }
    Ok(())
}

/// How far the frames' own estimates are from the measured errors, in a sentence.
fn claims(rows: &[Measurement]) -> String {
    let of_whole = rows.iter().filter(|m| m.has_indirect);
    let claims = of_whole.filter_map(|m| Some((m.claimed()?, &m.flags)));
    let order = |a: &(f64, _), b: &(f64, _)| a.0.total_cmp(&b.0);
    match (claims.clone().min_by(order), claims.max_by(order)) {
        (Some((least, at_least)), Some((most, at_most))) => format!(
            " That of direct light alone knows nothing of the indirect light that is missing; the others are {least:.2} \
             (`{at_least}`) to {most:.2} times (`{at_most}`) the measured error."
        ),
        _ => String::new(),
    }
}

fn bake(bake: &BakeCost) -> String {
    let [primary, secondary] = bake.records;
    format!(
        "The irradiance cache takes {:.2} s ({:.2} CPU s) for all {} frames: {primary} primary, {secondary} secondary \
         records, {:.1} MB.",
        bake.seconds,
        bake.cpu_seconds,
        bake.frames,
        1e-6 * bake.bytes as f64
    )
}

fn measurements(
    rows: &[Measurement],
    (width, height): (u32, u32),
    out: &mut String,
) -> std::fmt::Result {
    writeln!(
        out,
        "| technique | size | s | CPU s | s, {width}x{height} | million rays | million rays/s | relMSE | own relMSE | \
         RMSE | p95 error, % | mean bias, % | FLIP |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    )?;
    for m in rows {
        let (width, height) = m.size;
        let [low, high] = m.spread;
        let claimed = m.claimed().map(|of| format!(" ({of:.2})"));
        let own = format!("{:.2e}{}", m.own_estimate, claimed.unwrap_or_default());
        let [bias_low, bias_high] = m.mean_bias_interval.map(|bias| 100.0 * bias);
        writeln!(
            out,
            "| {}: `{}` | {width}x{height} | {:.4} | {:.4} | {:.4} | {:.2} | {:.1} | {:.2e} ({low:.2e} to {high:.2e}) | \
             {own} | {:.4} | {:.1} | {:+.2} ({bias_low:+.2} to {bias_high:+.2}) | {:.4} |",
            m.curve,
            m.flags,
            m.seconds,
            m.cpu_seconds,
            m.full_size_seconds,
            1e-6 * m.rays,
            1e-6 * m.rays_per_second,
            m.rel_mse,
            m.rmse,
            100.0 * m.p95_relative_error,
            100.0 * m.mean_bias,
            m.flip
        )?;
    }
    Ok(())
}
