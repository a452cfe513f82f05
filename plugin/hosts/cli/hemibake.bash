# SPDX-License-Identifier: MIT
# Which words may come next on the command line, in bash? Made by options_table.py; not edited by hand.
_hemibake() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "bake inspect compare render view factors help --help --version" -- "$word"))
    return
  fi
  case ${COMP_WORDS[1]}:$before in
    bake:--quality) COMPREPLY=($(compgen -W "draft medium high reference" -- "$word")); return ;;
    bake:--method) COMPREPLY=($(compgen -W "hybrid analytic pr fm rows auto" -- "$word")); return ;;
    bake:--visibility) COMPREPLY=($(compgen -W "osmesa egl rays auto" -- "$word")); return ;;
    bake:--normals) COMPREPLY=($(compgen -W "file faces" -- "$word")); return ;;
    bake:--subdivide-scheme) COMPREPLY=($(compgen -W "catmull-clark loop bilinear" -- "$word")); return ;;
    bake:--metals) COMPREPLY=($(compgen -W "rough black" -- "$word")); return ;;
    bake:--moving) COMPREPLY=($(compgen -W "rest leave" -- "$word")); return ;;
    bake:--progress) COMPREPLY=($(compgen -W "auto plain json" -- "$word")); return ;;
    inspect:--quality) COMPREPLY=($(compgen -W "draft medium high reference" -- "$word")); return ;;
    inspect:--method) COMPREPLY=($(compgen -W "hybrid analytic pr fm rows auto" -- "$word")); return ;;
    inspect:--visibility) COMPREPLY=($(compgen -W "osmesa egl rays auto" -- "$word")); return ;;
    inspect:--normals) COMPREPLY=($(compgen -W "file faces" -- "$word")); return ;;
    inspect:--metals) COMPREPLY=($(compgen -W "rough black" -- "$word")); return ;;
    inspect:--moving) COMPREPLY=($(compgen -W "rest leave" -- "$word")); return ;;
  esac
  case ${COMP_WORDS[1]} in
    bake) options="-o --quality --method --visibility --normals --error --time --unshot --element-size --patch-size --max-elements --refine-levels --refine-error --uniform --merge-error --stand-in --cluster-angle --hemicube --hemicube-light --light-tolerance --subdivide --subdivide-scheme --subdivide-adaptive --threads --seed --memory --sun --environment --emissive-scale --bounces --direct-only --ao --ao-distance --scene-linear --rows --lights-from --light-groups --vertex-errors --exposure --ocio --input-space --working-space --display --view --look --no-draco --metals --keep-pbr --keep-instances --draco-level --draco-bits --root --max-pixels --report --scene --moving --variant --time-code --keep-lamps --layer --preview --depfile --checkpoint --resume --reference --camera --look-from --look-at --size --flat --jobs --force --quiet --progress --help" ;;
    inspect) options="--quality --method --visibility --normals --element-size --patch-size --max-elements --stand-in --hemicube --subdivide --threads --memory --sun --environment --emissive-scale --ocio --input-space --working-space --metals --root --max-pixels --scene --moving --variant --time-code --strict --json --help" ;;
    compare) options="--root --scene --camera --look-from --look-at --heatmap --worst --size --json --help" ;;
    render) options="-o --root --scene --camera --look-from --look-at --all-cameras --turntable --size --flat --quiet --help" ;;
    view) options="--root --scene --reference --before --port --help" ;;
    factors) options="-o --tolerance --threads --root --quiet --help" ;;
    help) options="bake inspect compare render view factors" ;;
  esac
  case $word in
    -*) COMPREPLY=($(compgen -W "$options" -- "$word")) ;;
    *) [ "${COMP_WORDS[1]}" = help ] && COMPREPLY=($(compgen -W "$options" -- "$word")) || COMPREPLY=($(compgen -f -- "$word")) ;;
  esac
}
complete -o filenames -F _hemibake hemibake
