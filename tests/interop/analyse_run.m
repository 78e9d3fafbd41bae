% Analyses a run of phicam with Octave or MATLAB, and draws a figure of it. Meant to be read and copied.
%
%   octave --no-gui --quiet analyse_run.m DIR          from a shell, or
%   folder = 'DIR'; analyse_run                        within MATLAB or Octave
%
% Redoes two of phicam's recoveries, holds them against DIR/recovered, and writes DIR/analysis-octave.png. Needs a run with one hidden surface. Ends with an
% error, and so with exit code 1, where something disagrees. (Frames: MATLAB reads them with exrread, Octave does not; analyse_run.py checks them.)
if ~exist('folder', 'var')
  arguments = argv();
  folder = arguments{1};
end

% The matrices: .npy is 6 bytes of magic, the version, the length of the header (2 bytes in version 1, 4 after that), the header, and the numbers row by row.
names = {'phi', 'model/camera_side', 'model/laser_side', 'recovered/truth', 'recovered/pinv', 'recovered/tsvd', 'recovered/joint'};
read = cell(size(names));
for k = 1:numel(names)
  file = fopen([folder '/' names{k} '.npy'], 'r', 'ieee-le');
  magic_and_version = fread(file, 8, 'uint8')';
  if ~isequal(magic_and_version(1:6), [147 double('NUMPY')])
    error('%s.npy is no .npy file', names{k});
  end
  lengths = {'uint16', 'uint32'};
  header = fread(file, [1 fread(file, 1, lengths{min(magic_and_version(7), 2)})], 'uint8=>char');
  if isempty(strfind(header, '<f8')) || isempty(regexp(header, '''fortran_order'':\s*False', 'once'))
    error('%s.npy does not hold doubles row by row', names{k});
  end
  shape = regexp(header, '''shape'':\s*\((\d+),\s*(\d+)', 'tokens', 'once');
  shape = str2double(shape);
  read{k} = fread(file, [shape(2) shape(1)], 'double')';
  fclose(file);
end
[phi, C, D, truth, pinv_theirs, tsvd_theirs, joint] = read{:};   % Φcam = C·diag(ρ)·D, W
summary = jsondecode(fileread([folder '/summary.json']));
record = jsondecode(fileread([folder '/run.json']));

% Recovery as published: X = Φ·D⁺, divided by C entry by entry, mean over the pixels. Singular values at or below max(r, l)·eps·σ1 count as zero (pinv), or all but
% the first few (tsvd). How far two programs may be apart by rounding alone is derived in analyse_run.py: to first order in ‖E‖ = 2·√max(r, l)·eps·σ1,
% |Δx_j| ≤ ‖E‖·(a·‖x‖ + a·‖r‖/gap + b·‖x‖/gap) + 2·√l·eps·a·‖w‖, gap = σ_k − σ_(k+1) − ‖E‖. With so small a σ_k as that of pinv this allows half of the answer:
% there phicam is held to the scatter of Octave's own answers to the same question in other words (D or its transpose, rows and columns in another order, entries
% moved by up to eps/2 of themselves), and may be one decimal digit worse, since its decomposition is another algorithm than LAPACK's.
worse = 10;
[U, S, V] = svd(D, 'econ');
sigma = [diag(S); 0];
methods = {'pinv', 'tsvd'};
theirs = {pinv_theirs, tsvd_theirs};
found = cell(1, 2);
wrong = '';
lengths = @(m) sqrt(sum(m .^ 2, 1));
for k = 1:2
  of_method = summary.recovered(strcmp({summary.recovered.method}, methods{k}));
  kept = round(of_method.effective_rank);
  if k == 1
    rank_of_D = sum(sigma > max(size(D)) * eps * sigma(1));
  else
    rank_of_D = kept;
  end
  u = U(:, 1:rank_of_D);
  v = V(:, 1:rank_of_D);
  s = sigma(1:rank_of_D)';
  x = (phi * v) ./ s * u';
  rho = mean(x ./ C, 1);
  found{k} = reshape(rho, fliplr(size(truth)))';
  if k == 1
    rand('twister', 1);
    scatter = zeros(size(rho));
    for draw = 1:40
      [~, i] = sort(rand(1, size(D, 1)));
      [~, j] = sort(rand(1, size(D, 2)));
      same = D + eps / 2 * D .* (2 * rand(size(D)) - 1);
      if mod(draw, 2) == 1
        [u, s, v] = svd(same(i, j), 'econ');
      else
        [v, s, u] = svd(same(i, j)', 'econ');
      end
      kept_s = s(1:rank_of_D, 1:rank_of_D);
      answer = mean(phi(:, j) * v(:, 1:rank_of_D) / kept_s * u(:, 1:rank_of_D)' ./ C(:, i), 1);
      scatter(i) = max(scatter(i), abs(answer - rho(i)));
    end
    bound = worse * scatter;
  else
    w = phi' * (1 ./ C) / size(C, 1);
    x = u ./ s * (v' * w);
    r = w - v * (v' * w);
    perturbation = 2 * sqrt(max(size(D))) * eps * sigma(1);
    gap = s(end) - sigma(rank_of_D + 1) - perturbation;
    a = lengths((u ./ s)');
    b = sqrt(max(1 - lengths(u') .^ 2, 0));
    bound = perturbation * (a .* lengths(x) + a .* lengths(r) / gap + b .* lengths(x) / gap) + 2 * sqrt(max(size(D))) * eps * a .* lengths(w);
  end
  apart = abs(rho - reshape(theirs{k}', 1, []));
  largest = max(abs(theirs{k}(:)));
  fprintf('%s: rank %d, differs by %.1e of the largest value, %.1e allowed\n', methods{k}, rank_of_D, max(apart) / largest, max(bound) / largest);
  if rank_of_D ~= kept || ~all(apart <= bound)
    wrong = sprintf('%s%s differs from phicam''s (its rank %d) by up to %.2g times what is allowed\n', wrong, methods{k}, kept, max(apart ./ bound));
  end
end

% The figure. Octave without a display draws with gnuplot.
if exist('OCTAVE_VERSION', 'builtin') && isempty(getenv('DISPLAY'))
  warning('off', 'all');
  graphics_toolkit('gnuplot');
end
default_map = get(groot, 'DefaultFigureColormap');
picture = figure('visible', 'off', 'paperunits', 'inches', 'papersize', [7.1 4.2], 'paperposition', [0 0 7.1 4.2]);
[~, spot] = max(sum(phi, 1));
panels = {1e15 * reshape(phi(:, spot), record.pixels(1), record.pixels(2))', 1e15 * phi, sigma, truth, found{1}, found{2}, joint};
titles = {sprintf('frame of spot %d (fW)', spot - 1), 'Phicam (fW)', 'singular values of D', 'truth', 'pinv', 'tsvd', 'joint'};
across = {'column', 'spot', 'index', '', '', '', ''};
upwards = {'row', 'pixel', '\sigma_i/\sigma_1', '', '', '', ''};
places = {[0.06 0.57 0.22 0.33], [0.41 0.57 0.22 0.33], [0.76 0.57 0.22 0.33], [0.04 0.06 0.19 0.33], [0.28 0.06 0.19 0.33], [0.52 0.06 0.19 0.33], [0.76 0.06 0.19 0.33]};
for k = 1:7
  axes('position', places{k});
  if k == 3
    semilogy(sigma(1:end - 1) / sigma(1), '.', 'markersize', 6);
    hold on
    plot([1 numel(sigma)], max(size(D)) * eps * [1 1], '--k');
    set(gca, 'ytick', 10 .^ (-15:5:0), 'ylim', [1e-16 10]);
  else
    imagesc(0:size(panels{k}, 2) - 1, 0:size(panels{k}, 1) - 1, panels{k});
    axis xy
  end
  if k < 3
    set(colorbar, 'fontsize', 8);
    colormap(gca, default_map);
  elseif k > 3
    colormap(gca, gray(256));
    caxis([0 1]);
    axis image
    set(gca, 'xtick', [], 'ytick', []);
  end
  set(gca, 'fontsize', 8);
  xlabel(across{k}, 'fontsize', 8);
  ylabel(upwards{k}, 'fontsize', 8);
  title(titles{k}, 'fontweight', 'normal', 'fontsize', 8);
end
print(picture, [folder '/analysis-octave.png'], '-dpng', '-r200');
if ~isempty(wrong)
  error('%s', wrong);
end
