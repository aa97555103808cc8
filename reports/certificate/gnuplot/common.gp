# What all figures share. Colours are those of Okabe and Ito, told apart by the colour-blind.
black = '#000000'
blue = '#0072B2'
vermilion = '#D55E00'
orange = '#E69F00'
green = '#009E73'
purple = '#CC79A7'
sky = '#56B4E9'
grey = '#666666'
# Done again for each figure, after `reset`.
common = "set encoding utf8; set decimalsign '.'; set samples 2; \
set border 3 linewidth 0.8 linecolor rgb grey; set tics nomirror out scale 0.5; \
set grid linewidth 0.6 linecolor rgb '#dddddd'; \
set key noenhanced outside below horizontal left reverse Left samplen 2.5 spacing 1.15 width -3"
