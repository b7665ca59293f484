//! Worked examples for the help of each verb. Lines have at most 80 columns; a test runs the commands one after the other, in the
//! order of the verbs, in a folder with the photographs of the demonstration.

/// At the end of `slcal --help`.
pub(super) const ALL: &str = "\
Exit codes: 0 done; 2 wrong command line; 3 input unreadable or malformed;
4 sheet, pattern or stripes not found; 5 geometry degenerate; 1 other errors.

Start with `slcal demo`.";

pub(super) const DEMO: &str = "\
Example:
    slcal demo --out demo

writes the patterns, the photographs, rig.json, clouds, pictures of what was
found and report.html into demo/, and compares the results with the ground
truth.";

#[cfg(feature = "studio")]
pub(super) const STUDIO: &str = "\
Examples:
    slcal studio --demo
    slcal studio --projector 1920x1080 --size A3
    slcal studio --dir scans --watch ~/Pictures/tethered --lan

The first needs no hardware. The second calibrates with a webcam. The third takes
photographs that a camera writes into a folder, or a phone sends. The display
page goes onto the projector, full screen.";

pub(super) const CHECKER: &str = "\
Example:
    slcal pattern checker --projector 1024x768 -o checker.png

writes checker.png, the picture to show full screen at the native resolution of
the projector, and checker.json, the description that `slcal calibrate` needs.";

pub(super) const STRIPES: &str = "\
Example:
    slcal pattern stripes --projector 1024x768 -o stripes.png

writes stripes.png, the picture to show full screen at the native resolution of
the projector, and stripes.json, the description that `slcal reconstruct` needs.";

pub(super) const GRAY: &str = "\
Example:
    slcal pattern gray --projector 1024x768 --out-dir gray

writes gray/frame_000.png to gray/frame_021.png, the pictures to show one after
another, full screen at the native resolution of the projector, and
gray/sequence.json, their description.";

pub(super) const PHASE: &str = "\
Example:
    slcal pattern phase --projector 1024x768 --out-dir phase

writes phase/frame_000.png to phase/frame_023.png, the pictures to show one
after another, full screen at the native resolution of the projector, and
phase/sequence.json, their description.

Photographs of an orange sphere under them, with ground truth, to try them on:
    slcal simulate scene --surface sphere --albedo 0.9,0.5,0.2 \\
        --pattern phase/sequence.json --camera 640x480 --focal 750 --out orange";

pub(super) const CALIBRATE: &str = "\
Examples:
  From one photograph of an A2 sheet in landscape with the checkerboard on it:
    slcal calibrate sheet.jpg --size A2-landscape --pattern checker.json \\
        -o rig.json
  From several photographs, which is far better, and keep the measurements:
    slcal calibrate a.jpg b.jpg c.jpg --size 594x420mm --pattern checker.json \\
        -o rig.json --save-observations seen.json
  With a known camera:
    slcal calibrate sheet.jpg --size A2-landscape --pattern checker.json \\
        --camera rig.json -o known.json
  The camera alone, with a picture of what was found:
    slcal calibrate sheet.jpg --size A2-landscape -o camera.json \\
        --overlay seen.png";

pub(super) const ADVISE: &str = "\
Examples:
  What one more photograph would add:
    slcal advise --rig rig.json --pattern checker.json
  Before the first photograph, for a phone and a projector of throw ratio 1.5:
    slcal advise --image 4000x3000 --focal-35mm 28 --size A2-landscape \\
        --projector 1920x1080 --throw 1.5

The numbers are predictions from the Jacobian of the calibration.";

pub(super) const RECTIFY: &str = "\
Examples:
    slcal rectify --rig rig.json --pattern checker.json -o straight.png
    slcal rectify --rig rig.json --image head.jpg -o poster.png";

pub(super) const VERIFY: &str = "\
Examples:
  Has the rig moved? Check at any time with the checkerboard as it was drawn:
    slcal verify --rig rig.json --pattern checker.json --as-drawn sheet.jpg \\
        --fail-if-moved
  How square is a rectified projection? Project upright.png and photograph it:
    slcal rectify --rig rig.json --pattern checker.json -o upright.png
    slcal verify --rig rig.json --pattern checker.json photo.jpg";

pub(super) const DECODE: &str = "\
Example:
    slcal decode --pattern stripes.json board.jpg -o matches.csv \\
        --overlay stripes_seen.png

matches.csv: u,v,projector_column,slit,confidence,sigma_px; one row per stripe
and image row.";

pub(super) const TRIANGULATE: &str = "\
Example:
    slcal triangulate --rig rig.json matches.csv -o points.ply

The table needs the columns u, v and projector_column or projector_row (or
both).";

pub(super) const RECONSTRUCT: &str = "\
Examples:
  One photograph, with triangles between the points:
    slcal reconstruct --rig rig.json --pattern stripes.json board.jpg \\
        -o cloud.ply --mesh
  Many, into a folder; run it again to continue after an interruption:
    slcal reconstruct --rig rig.json --pattern stripes.json board.jpg head.jpg \\
        --out-dir clouds --resume
  A video, as raw frames:
    ffmpeg -i scan.mkv -f rawvideo -pix_fmt rgb24 - | \\
        slcal reconstruct --rig rig.json --pattern stripes.json \\
        --raw 1280x960:rgb24 --out-dir video";

pub(super) const EVALUATE: &str = "\
Example:
    slcal evaluate plane cloud.ply

The fit is robust: the cloud may contain other surfaces, such as a wall.";

pub(super) const REPORT: &str = "\
Examples:
    slcal report --rig rig.json -o report.html
    slcal report --rig rig.json --pattern checker.json --photo sheet.jpg \\
        --cloud cloud.ply -o with_cloud.html

The file needs no network and no other file: open it in a browser, send it or
print it. The report states what is left out because a file is missing.";

pub(super) const EXPORT: &str = "\
Examples:
    slcal export --rig rig.json --to opencv -o opencv.yml
  A file per device; the projector's becomes ros_projector.yaml:
    slcal export --rig rig.json --to ros -o ros.yaml
  A folder:
    slcal export --rig rig.json --to colmap -o model
  A script, for `blender --python rig.py -- --picture stripes.png`; it cannot
  hold lens distortion, so --lossy is needed:
    slcal export --rig rig.json --to blender -o rig.py --lossy

Messages list what a format cannot hold. A loss that would move pixels is an
error unless --lossy is given. docs/exchange.md has the conventions of each
format.";

pub(super) const IMPORT: &str = "\
Examples:
    slcal import opencv.yml -o from_opencv.json
    slcal import ros.yaml ros_projector.yaml -o from_ros.json
    slcal import model -o from_colmap.json

Files that do not state the image sizes need --camera-size and
--projector-size.";

pub(super) const NOISE: &str = "\
Example:
    slcal simulate noise --levels 0.1,0.5 --draws 20 --csv noise.csv

prints, per level and method: reprojection errors, the 3D error in per cent of a
reference cube, errors of focal lengths and translation, and the Cramér–Rao
bound, below which no unbiased estimator can be.";

pub(super) const VIEWS: &str = "\
Example:
    slcal simulate views --poses 10 --noise 0.1 -o ten.json --truth truth.json
    slcal calibrate --observations ten.json -o ten_rig.json

writes simulated observations of ten poses, and the true rig to compare
ten_rig.json with.";

pub(super) const SCENE: &str = "\
Examples:
  A sheet with the checkerboard:
    slcal simulate scene --surface sheet --out paper
    slcal calibrate paper/photo.png --size 594x420mm \\
        --pattern paper/pattern.json -o paper_rig.json
  Paper that curls by 0.5 % of its width about a slanted axis, under a projector
  with decentred optics; on a foam board it would be --thickness 5mm:
    slcal simulate scene --surface sheet --bend 0.5%,20 \\
        --projector-distortion=-0.02,0.01,3e-4,2e-4 --out curled
  A sphere with the stripes, noise and colour crosstalk:
    slcal simulate scene --surface sphere --noise 3 --crosstalk 0.2 --out ball
    slcal reconstruct --rig paper_rig.json --pattern ball/pattern.json \\
        ball/photo.png -o ball.ply
    slcal triangulate --rig ball/rig.json ball/truth_matches.csv -o true.ply

  A photograph under each picture of a sequence:
    slcal pattern phase --projector 1024x768 --out-dir shifts
    slcal simulate scene --surface sphere --pattern shifts/sequence.json \\
        --camera 640x480 --focal 750 --out stack

The folder then holds photo.png, white.png and black.png (full and no light),
pattern.png and pattern.json, rig.json (the truth), truth_matches.csv (the exact
image of each slit or corner), truth_cloud.ply (their points), and for every
pixel truth_column.pfm, truth_row.pfm (projector px, NaN without projector
light), truth_depth.pfm (mm) and truth_surface.png (0 nothing, 1 the first
surface, ...). Under a sequence it holds frame_000.png, frame_001.png, ...,
sequence.json, rig.json and these four.";

pub(super) const BUG_REPORT: &str = "\
Examples:
    slcal bug-report . --dry-run
    slcal bug-report . -o bug-report.zip

The first lists what the second packs. Nothing is sent: look at the archive,
then attach it to your report. Whole photographs tell more than their
thumbnails; attach those that you may share as well.";

pub(super) const COMPLETIONS: &str = "\
Examples:
  For bash, zsh (its fpath must hold ~/.zfunc) and fish:
    slcal completions bash > ~/.local/share/bash-completion/completions/slcal
    slcal completions zsh > ~/.zfunc/_slcal
    slcal completions fish > ~/.config/fish/completions/slcal.fish";

pub(super) const MAN: &str = "\
Examples:
    slcal man | man -l -
    slcal man --out manual

The second command writes a page for each verb; `man` finds them in
~/.local/share/man/man1.";
