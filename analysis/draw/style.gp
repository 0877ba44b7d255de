# style.gp - what the pictures share: colours, sizes, texts, tics. Loaded once, before the picture and
# its data; what it defines are variables and functions, some of which give a command to `eval`. What
# functions change has names that begin with f_.
set encoding utf8

# ---- colours: after Okabe and Ito (2008), so that readers who do not tell red from green tell these
# apart; blue hues stand for standing, green for walking, orange for falling. Outcomes in grey: 69, 112, 136,
# 157, 191 and 228 of 255 ----
colour_stabilised = 0x005a92
colour_rested = 0x56b4e9
colour_walks = 0x2db87c
colour_fell = 0xf3bb4c
colour_undecided = 0xa45288
colour_done = 0x009e73
colour_failed = 0x000000
colour_pending = 0xe4e4e4
# Of curves side by side.
array hue[7] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x000000]
grey = 0x8a8a8a
no_number = 0xd9d9d9

# What linear theory allows any controller: a line of its own dashes, on maps over a white one; beside several
# outlines thin lines, with the dashes of each.
colour_allowed = 0x000000
set dashtype 11 (9,5)
set dashtype 12 (1,0)
thin(dash) = dash == 12
# Numbers: after cividis (Nunez, Anderton, Renslow 2018), even steps for every reader.
palette = "set palette defined (0 '#00224e', 0.25 '#434e6c', 0.5 '#7d7c78', 0.75 '#bcae6c', 1 '#fee838')"
all_grey = 0
in_grey = "all_grey = 1; colour_stabilised = 0x404040; colour_rested = 0x8a8a8a; colour_walks = 0x666666; colour_fell = 0xdcdcdc; colour_undecided = 0xb0b0b0; " \
    ."colour_done = 0x606060; colour_pending = 0xf6f6f6; array hue[7] = [0x000000, 0x7a7a7a, 0x404040, 0xa6a6a6, 0x202020, " \
    ."0x909090, 0x5a5a5a]; no_number = 0xffffff; palette = \"set palette defined (0 '#101010', 1 '#f0f0f0')\""
# Of a colour that stands for one thing alone.
shade(c) = all_grey ? 0x010101*int(0.3*(c>>16&255) + 0.59*(c>>8&255) + 0.11*(c&255)) : c
grid = "set grid lt 1 lc rgb '#e6e6e6' lw 0.8"

# ---- the canvas: page_width x page_height px, from its upper left corner ----
margin = 18.0
X(px) = 1.0*px/page_width
Y(px) = 1 - 1.0*px/page_height
panel(left, top, width, height) = sprintf( \
    "set lmargin at screen %.6f; set rmargin at screen %.6f; set tmargin at screen %.6f; set bmargin at screen %.6f", \
    X(left), X(left + width), Y(top), Y(top + height))
# What is left for each of n panels in a row, of a width that was asked for; else `own` px.
wide(own, n, others) = asked_width > 0 ? at_least(60, 1.0*(asked_width - others)/n) : own
at_least(a, b) = a > b ? a : b
at_most(a, b) = a < b ? a : b
colour_bar(left, top, width, height) = sprintf( \
    "set colorbox %s user origin screen %.6f, screen %.6f size screen %.6f, screen %.6f", \
    width > height ? 'horizontal' : 'vertical', X(left), Y(top + height), X(width), 1 - Y(height))

# ---- texts; DejaVu Sans takes 0.69 of its size per letter on the average ----
title_size = 15
text_size = 12
small = "font ',11'"
tiny = "font ',10'"
letters(px, size) = int(px/(0.69*size))
# Up to n letters a line, broken at blanks and seams, zero-width spaces between wide letters; a word that is longer
# has a line of its own.
seam = "\342\200\213"
bare(s) = strstrt(s, seam) < 1 ? s : strlen(s) < 2 ? '' : bare(s[1:strlen(s)/2]).bare(s[strlen(s)/2+1:*])
blank(s, i) = i < 1 || s[i:i] eq ' ' || s[i:i] eq seam ? i : blank(s, i - 1)
wrap(s, n) = strlen(s) <= n ? bare(s) : (f_at = blank(s, n + 1), f_at = f_at < 1 ? strstrt(s, ' ') : f_at, \
    f_at < 1 ? bare(s) : bare(s[1:f_at-1])."\n".wrap(s[f_at+1:*], n))
lines(s) = (f_at = strstrt(s, "\n"), f_at < 1 ? 1 : 1 + lines(s[f_at+1:*]))
lines_height(s, size) = s eq '' ? 0 : lines(s)*(int(size*1.25) + 3)
longest_line(s) = (f_at = strstrt(s, "\n"), f_at < 1 ? strlen(s) : at_least(f_at - 1, longest_line(s[f_at+1:*])))
cut(s, n) = strlen(s) <= n || n < 4 ? s : s[1:n-3].'...'
# Of "controller.sample_time = 0.002 s" the end, which has the value.
end_of(s, n) = strlen(s) <= n ? s : strstrt(s, '.') > 0 && strstrt(s, '.') < strstrt(s, ' ') ? end_of(s[strstrt(s, '.')+1:*], n) \
    : '...'.s[at_least(1, strlen(s) - int(n) + 4):*]
# What the title and the line under it take of a page that is page_width wide.
title_text(s, size) = wrap(s, letters(page_width - 2*margin, size))
title_height(_) = margin + lines_height(title_text(title, title_size), title_size) \
    + lines_height(title_text(subtitle, text_size), text_size) + (title eq '' && subtitle eq '' ? 0 : 10)
# Long name, where there is room for it, if need be without the "initial offset: " that paths say, too, and path of an
# axis, in `px` pixels each; as the label of x, set under `middle` or as near to it as the page has room; a text that is
# read upwards beside it.
long_name(s, n) = strlen(s) <= n ? s : strstrt(s, ': ') > 0 ? long_name(s[strstrt(s, ': ')+2:*], n) : ''
axis_label(a, px) = (f_name = long_name(value(a.'_text'), int(px/6.9)), f_name eq '' ? '' : f_name."\n") \
    .end_of(value(a.'_path'), int(px/6.9))
y_label(text, left, middle) = (f_label = text, sprintf("set label f_label at screen %.17g,%.17g center rotate by 90 %s front", \
    X(left), Y(middle), small))
x_label(middle, y) = (f_label = axis_label('x', page_width - 2*margin), f_half = 3.6*longest_line(f_label) + 4, \
    sprintf("set label f_label at screen %.6f,%.6f center %s front", \
        X(at_least(f_half, at_most(middle, page_width - f_half))), Y(y), small))

# ---- charts: see chart.gp. Panels as the data have them: its own height in px, a heading in up to three forms, what
# stands at the right over it and beside it, axes, series; and where they come to stand ----
array panel_own[40]; array panel_heading[40]; array panel_short[40]; array panel_bare[40]; array panel_right[40]
array panel_aside[40]; array panel_aside_bare[40]; array panel_x[40]; array panel_y[40]; array panel_plot[40]; array panel_wordy[40]
array panel_top[40]; array panel_high[40]
panels = 0
new_panel = "panel_plot[panels] = ''; panel_heading[panels] = ''; panel_short[panels] = ''; panel_bare[panels] = ''; " \
    ."panel_right[panels] = ''; panel_aside[panels] = ''; panel_aside_bare[panels] = ''; panel_wordy[panels] = 0"
left = 104
columns = 1       # at most
leads = 0
chart_width = 620 # px, of a panel
lead_width = 520; lead_own = 520
scaled = 0        # heights follow widths
gridded = 1
plain = 0         # panels have neither frame nor axes
equal = 0         # both directions have the same scale
legend_low = 0    # the legend stands below the panels
frames = 1        # of a picture that moves, frame_step apart: the ranges of its panel are from centre[], base[]
travels = 0       # they move
ground = -1       # colour under what is drawn
shared_y = ''
chart_beside = '' # the name of a strip
column_name = ''; row_name = ''
chart_fit = 'f_fit = 0' # what follows from their width
stretches = 0; ends = 0; longest_end = 0
bar_low = 0; bar_high = 1; bar_text = ''; bar_format = '%g'
# The legend as a table under the panels: its rows are entries, cell_text[] and, under them, cell_more[] row by row.
table_columns = 0
table_top = 0; table_names = 290

# ---- legends: marks with texts, and notes under them; the data add theirs. A mark is a line where it has a type of
# dashes, a point where it has a type of points, or a filled box ----
array legend_text[40]
array legend_colour[40]
array legend_dash[40]
array legend_point[40]
array legend_about[40] # lines under an entry
array note[60]
bars = 0
legends = 0
notes = 0
legend_step = 24
legend_head = ''
legend_x = 0
legend_y = 0
box(left, y, colour) = sprintf("set object rectangle from screen %.6f,%.6f to screen %.6f,%.6f fillcolor rgb %d " \
    ."fillstyle solid border lc '#606060' lw 0.5 front", X(left), Y(y + 7), X(left + legend_indent - 8), Y(y - 7), colour)
line_mark(left, y, colour, dash) = sprintf("set arrow from screen %.6f,%.6f to screen %.6f,%.6f nohead lc rgb %d dt %d " \
    ."lw %g front", X(left), Y(y), X(left + legend_indent - 8), Y(y), colour, dash, thin(dash) ? 0.8 : 2)
point_mark(left, y, colour, type) = sprintf("set label '' at screen %.6f,%.6f point pt %d ps 1.4 lw 2 lc rgb %d front", \
    X(left + 0.5*legend_indent - 4), Y(y), type, colour)
mark(k, left, y) = legend_point[k] < 0 ? '' : legend_dash[k] + legend_point[k] == 0 ? box(left, y, legend_colour[k]) \
    : (legend_dash[k] > 0 ? line_mark(left, y, legend_colour[k], legend_dash[k]) : '').'; ' \
    .(legend_point[k] > 0 ? point_mark(left, y, legend_colour[k], legend_point[k]) : '')
# The colour bar of the page: under the legend's entries.
legend_bar(_) = legend_below ? colour_bar(left, page_height - 80, at_most(280, asked_width - left - 3*margin), 12) \
    : colour_bar(legend_x, legend_y + bar_y, 18, 180)

# ---- tics of the axis whose name begins with x or y: about n, two at least ----
round_up(x) = (f_power = 10.0**floor(log10(x)), f_digit = x/f_power*(1 - 1e-9), \
    (f_digit <= 1 ? 1 : f_digit <= 2 ? 2 : f_digit <= 5 ? 5 : 10)*f_power)
round_step(low, high, n) = high > low ? round_up(1.0*(high - low)/(n > 1 ? n : 1)) : 1.0
tic(text, place) = sprintf(", '%s' %.17g", text, place)
range(a, low, high) = sprintf("set %srange [%.17g:%.17g]; set %stics ", a[1:1], low, high, a[1:1])
# Of a step that leaves fewer than two in sight, the first and the last of the next one that does not.
tic_first(low, step) = step*ceil(low/step - 1e-9)
tic_last(high, step) = step*floor(high/step + 1e-9)
two_step(low, high, n) = (f_step = round_step(low, high, n), \
    n < 20 && tic_last(high, f_step) - tic_first(low, f_step) < 0.5*f_step ? two_step(low, high, n + 1) : f_step)
linear_tics(a, low, high, n, labelled) = (f_round = round_step(low, high, n), f_two = two_step(low, high, n), \
    range(a, low, high).(f_two == f_round ? sprintf('%.10g', f_round) : (f_from = tic_first(low, f_two), \
        f_to = tic_last(high, f_two), sprintf('%.10g,%.10g,%.10g', f_from, f_to - f_from, f_to))) \
    .sprintf("; set format %s '%s'", a[1:1], labelled ? '%.10g' : ''))
# Places are decimal logarithms, low and high too.
# Less than a decade has round steps, more the mantissas for which there is room.
round_tics(low, high, n, labelled) = (f_tics = '', f_count = 0, f_step = round_step(10**low, 10**high, n), \
    sum [f_i=int(ceil(10**low/f_step - 1e-9)):int(floor(10**high/f_step + 1e-9))] (f_count = f_count + 1, f_tics = f_tics \
        .tic(labelled ? sprintf('%g', f_i*f_step) : '', log10(f_i*f_step)), 0), \
    f_count < 2 && n < 20 ? round_tics(low, high, n + 1, labelled) : f_tics[3:*])
digit_tics(low, high, n, labelled) = (f_tics = '', f_count = 0, f_every = int(ceil((high - low)/n)), \
    f_digits = n >= 3*(high - low) ? '1 2 5' : n >= 2*(high - low) ? '1 3' : '1', \
    sum [f_i=int(floor(low)):int(ceil(high))] sum [f_k=1:words(f_digits)] (f_place = f_i + log10(word(f_digits, f_k) + 0), \
        f_place > low - 1e-9 && f_place < high + 1e-9 && f_i % f_every == 0 ? (f_count = f_count + 1, f_tics = f_tics \
            .tic(labelled ? sprintf('%g', 10**f_place) : '', f_place), 0) : 0), \
    f_count < 2 && n < 20 ? digit_tics(low, high, n + 1, labelled) : f_tics[3:*])
log_tics(a, low, high, n, labelled) = range(a, low, high).'(' \
    .(high - low < 0.8 ? round_tics(low, high, n, labelled) : digit_tics(low, high, n, labelled)).')'
# Words, and numbers without an even spacing: every so-manieth of those that the data name.
list_tics(a, low, high, n, labelled) = value(a.'_words') < 1 ? range(a, low, high).'()' : (f_tics = '', f_every = (value(a.'_words') + int(n) - 1)/int(n), \
    sum [f_i=0:(value(a.'_words') - 1)/f_every] (f_tics = f_tics.sprintf(', %s %s_at[%d]', \
        labelled ? sprintf('%s_word[%d]', a, f_i*f_every + 1) : "''", a, f_i*f_every + 1), 0), range(a, low, high).'('.f_tics[3:*].')')
# Range and tics of the axis that the data describe.
axis_tics(a, n, labelled) = (f_n = at_least(2, n), \
    value(a.'_scale') eq 'linear' ? linear_tics(a, value(a.'_low'), value(a.'_high'), f_n, labelled) \
    : value(a.'_scale') eq 'log' ? log_tics(a, value(a.'_low'), value(a.'_high'), f_n, labelled) \
    : list_tics(a, value(a.'_low'), value(a.'_high'), f_n, labelled))
