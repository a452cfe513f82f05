# SPDX-License-Identifier: MIT
# Which words may come next on the command line, in bash? Made by options_table.py; not edited by hand.
_hemibake() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]} words= files=
  COMPREPLY=()
  # Bash takes --quality=high for three words.
  if [ "$word" = = ]; then
    word=
  elif [ "$before" = = ]; then
    before=${COMP_WORDS[COMP_CWORD-2]}
  fi
  [ "$COMP_CWORD" -eq 1 ] && before= command=
  case $command:$before in
    :) words="bake inspect compare render view factors help --help --version" ;;
    bake:-o|bake:--output|bake:--environment|bake:--rows|bake:--lights-from|bake:--ocio|bake:--root|bake:--report|bake:--layer|bake:--preview|bake:--depfile|bake:--checkpoint|bake:--resume|bake:--reference) files=yes ;;
    bake:--quality) words="draft medium high reference" ;;
    bake:--method) words="hybrid analytic pr fm rows auto" ;;
    bake:--visibility) words="osmesa egl rays auto" ;;
    bake:--normals) words="file faces" ;;
    bake:--error|bake:--time|bake:--unshot|bake:--element-size|bake:--patch-size|bake:--max-elements|bake:--refine-levels|bake:--refine-error|bake:--merge-error|bake:--stand-in|bake:--cluster-angle|bake:--hemicube|bake:--hemicube-light|bake:--light-tolerance|bake:--threads|bake:--seed|bake:--memory|bake:--sun|bake:--emissive-scale|bake:--bounces|bake:--ao-distance|bake:--working-space|bake:--display|bake:--view|bake:--look|bake:--draco-level|bake:--draco-bits|bake:--max-pixels|bake:--variant|bake:--time-code|bake:--camera|bake:--look-from|bake:--look-at|bake:--size|bake:--jobs) : ;;
    bake:--subdivide|bake:--exposure) words="auto" ;;
    bake:--subdivide-scheme) words="catmull-clark loop bilinear" ;;
    bake:--input-space) words="file-rules" ;;
    bake:--metals) words="rough black" ;;
    bake:--scene) words="all" ;;
    bake:--moving) words="rest leave" ;;
    bake:--progress) words="auto plain json" ;;
    inspect:--quality) words="draft medium high reference" ;;
    inspect:--method) words="hybrid analytic pr fm rows auto" ;;
    inspect:--visibility) words="osmesa egl rays auto" ;;
    inspect:--normals) words="file faces" ;;
    inspect:--element-size|inspect:--patch-size|inspect:--max-elements|inspect:--stand-in|inspect:--hemicube|inspect:--threads|inspect:--memory|inspect:--sun|inspect:--emissive-scale|inspect:--working-space|inspect:--max-pixels|inspect:--variant|inspect:--time-code) : ;;
    inspect:--subdivide) words="auto" ;;
    inspect:--environment|inspect:--ocio|inspect:--root) files=yes ;;
    inspect:--input-space) words="file-rules" ;;
    inspect:--metals) words="rough black" ;;
    inspect:--scene) words="all" ;;
    inspect:--moving) words="rest leave" ;;
    compare:--root|compare:--heatmap) files=yes ;;
    compare:--scene) words="all" ;;
    compare:--camera|compare:--look-from|compare:--look-at|compare:--worst|compare:--size) : ;;
    render:-o|render:--output|render:--root) files=yes ;;
    render:--scene) words="all" ;;
    render:--camera|render:--look-from|render:--look-at|render:--turntable|render:--size) : ;;
    view:--root|view:--reference|view:--before) files=yes ;;
    view:--scene) words="all" ;;
    view:--port) : ;;
    factors:-o|factors:--output|factors:--root) files=yes ;;
    factors:--tolerance|factors:--threads) : ;;
    help:*) words="bake inspect compare render view factors all-cameras ao ao-distance before bounces camera checkpoint cluster-angle depfile direct-only display draco-bits draco-level element-size emissive-scale environment error exposure flat force heatmap hemicube hemicube-light input-space jobs json keep-instances keep-lamps keep-pbr layer light-groups light-tolerance lights-from look look-at look-from max-elements max-pixels memory merge-error metals method moving no-draco normals ocio patch-size port preview progress quality quiet reference refine-error refine-levels report resume root rows scene scene-linear seed size stand-in strict subdivide subdivide-adaptive subdivide-scheme sun threads time time-code tolerance turntable uniform unshot variant vertex-errors view visibility working-space worst" ;;
    bake:*) case $word in -*) words="-o --output --quality --method --visibility --normals --error --time --unshot --element-size --patch-size --max-elements --refine-levels --refine-error --uniform --merge-error --stand-in --cluster-angle --hemicube --hemicube-light --light-tolerance --subdivide --subdivide-scheme --subdivide-adaptive --threads --seed --memory --sun --environment --emissive-scale --bounces --direct-only --ao --ao-distance --scene-linear --rows --lights-from --light-groups --vertex-errors --exposure --ocio --input-space --working-space --display --view --look --no-draco --metals --keep-pbr --keep-instances --draco-level --draco-bits --root --max-pixels --report --scene --moving --variant --time-code --keep-lamps --layer --preview --depfile --checkpoint --resume --reference --camera --look-from --look-at --size --flat --jobs --force --quiet -q --progress --help" ;; *) files=yes ;; esac ;;
    inspect:*) case $word in -*) words="--quality --method --visibility --normals --element-size --patch-size --max-elements --stand-in --hemicube --subdivide --threads --memory --sun --environment --emissive-scale --ocio --input-space --working-space --metals --root --max-pixels --scene --moving --variant --time-code --strict --json --help" ;; *) files=yes ;; esac ;;
    compare:*) case $word in -*) words="--root --scene --camera --look-from --look-at --heatmap --worst --size --json --help" ;; *) files=yes ;; esac ;;
    render:*) case $word in -*) words="-o --output --root --scene --camera --look-from --look-at --all-cameras --turntable --size --flat --quiet -q --help" ;; *) files=yes ;; esac ;;
    view:*) case $word in -*) words="--root --scene --reference --before --port --help" ;; *) files=yes ;; esac ;;
    factors:*) case $word in -*) words="-o --output --tolerance --threads --root --quiet -q --help" ;; *) files=yes ;; esac ;;
  esac
  # A line of compgen is a name, whatever blanks it has.
  [ -z "$words" ] || mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  [ -z "$files" ] || { compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$word"); }
}
complete -F _hemibake hemibake
