# plot_convergence.gp - a search over its candidates: what they were worth, the mean of the distribution, its width.
left = 104 # room for tics of five letters
hue_of(k) = named ? hue[(k-1) % 7 + 1] : grey
dash_of(k) = named ? (k-1)/7 % 5 + 1 : 1
named_room = 10
if (named) { do for [k=1:numbers] { named_room = at_least(named_room, 24 + 7.4*strlen(end_text[k])) } }
right = at_least(legend_room, named_room)
width = wide(560, 1, left + right)
gap = 16
# Of the height ten parts are the first panel's, eight the second's, four the third's.
page_width = left + width + right
top = title_height(0)
part = high(28, 22, top + 2*gap + 22 + 74)
height = 10*part
top = top + 22
mean_top = top + height + gap
mean_height = 8*part
width_top = mean_top + mean_height + gap
width_height = 4*part
page_height = width_top + width_height + 74
load 'page.gp'
side(text, from, high) = sprintf("set label '%s' at screen %.6f,%.6f center rotate by 90 %s front", \
    cut(text, (high + gap)/6.6), X(22), Y(from + 0.5*high), small)
eval side(worth, top, height)
eval side('change of the mean', mean_top, mean_height)
eval side('st. dev.', width_top, width_height)
set label 'candidate' at screen X(left + 0.5*width), Y(page_height - legend_height - 30) center @small front
at(x) = left + width*x/candidates
do for [k=1:stages] {
    if (width*(stage_to[k] - stage_from[k])/candidates > 7*strlen(stage_text[k])) {
        set label stage_text[k] at screen X(at(0.5*(stage_from[k] + stage_to[k]))), Y(top - 11) center @small front
    }
    if (k < stages) {
        set arrow from screen X(at(stage_to[k])),Y(top) to screen X(at(stage_to[k])),Y(width_top + width_height) nohead lc rgb '#b8b8b8' lw 1 back
    }
}
# Names at the ends of their lines, apart from each other: up from the lowest, then down from the highest.
if (named) {
    array name_y[numbers]
    step = at_most(14, (mean_height + gap)/numbers)
    do for [k=1:numbers] {
        name_y[k] = mean_top + mean_height*(mean_high - end_at[k])/(mean_high - mean_low)
        if (k > 1) { name_y[k] = at_most(name_y[k], name_y[k-1] - step) }
    }
    name_y[numbers] = at_least(name_y[numbers], mean_top)
    do for [i=1:numbers-1] { k = numbers - i; name_y[k] = at_least(name_y[k], name_y[k+1] + step) }
    do for [k=1:numbers] {
        y = mean_top + mean_height*(mean_high - end_at[k])/(mean_high - mean_low)
        set label end_text[k] at screen X(left + width + 22), Y(name_y[k]) left @tiny front
        set arrow from screen X(left + width + 2),Y(y) to screen X(left + width + 19),Y(name_y[k]) nohead \
            lc rgb hue_of(end_number[k]) lw 1 front
    }
}
eval column_legend
load 'panels.gp'

eval grid
eval panel(left, top, width, height)
eval linear_tics('x', 0, candidates, width/70, 0)
eval panel_tics(low, high, height)
size = candidates > 4000 ? 0.2 : candidates > 400 ? 0.35 : 0.6
plot $candidates using 1:2 with points pt 7 ps size lc rgb grey notitle, \
    for [k=3:1:-1] curve_at[k] with lines lc rgb curve_colour(k) dt curve_dash(k) lw 2.2 notitle, \
    $best using 1:2 with lines lc rgb 'black' lw 2 notitle

eval panel(left, mean_top, width, mean_height)
eval linear_tics('x', 0, candidates, width/70, 0)
eval panel_tics(mean_low, mean_high, mean_height)
plot for [k=1:numbers] $mean using 1:k+1 with lines lc rgb hue_of(k) \
    dt dash_of(k) lw (named ? 1.8 : 0.8) notitle

eval panel(left, width_top, width, width_height)
eval linear_tics('x', 0, candidates, width/70, 1)
eval log_tics('y', width_low, width_high, at_least(2, int(width_height/28)), 1, 1)
set logscale y
plot for [k=1:numbers] $width using 1:k+2 with lines lc rgb grey lw 0.8 notitle, \
    $width using 1:2 with lines lc rgb 'black' lw 2 notitle
unset logscale y
