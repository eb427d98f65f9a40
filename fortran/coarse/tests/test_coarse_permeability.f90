!> Regions of permeability on the coarse level: shares of cells, layered means, which region a cell
!! belongs to, and flow that is exact where the mesh follows the outlines.
program test_coarse_permeability
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_diffusion, only: cell_outflow, corner_gradient, region_fluxes
   use coarse_matrix, only: matrix_t
   use coarse_model, only: coarse_model_t, new_state
   use coarse_permeability, only: bearable, conduction_t, layered, place_regions, share_of_cell
   use coarse_regions, only: regions_t
   use coarse_rock, only: new_rock, resistivity_of, rock_t
   use coarse_state, only: state_t, step_report_t
   use coarse_stencils, only: discretize
   use contact_law, only: contact_law_t
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use sample_bodies, only: advance, boxes, cell_centre, hold, load_sides, mesh_square, &
                            porous_body, set_permeability, straight_network, uniform_cells
   use scene_types, only: region_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: tiny_error = 1.0e-13_rk
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers
   type(step_report_t) :: report
   type(mesh_t) :: mesh
   type(scene_t) :: scene

   call test_shares()
   call test_layers()
   call test_bearable()
   call test_sealing_sheet()
   call test_bounds()
   call test_order()
   call test_neighbours()
   call test_piecewise_linear([1.0_rk, 0.0_rk], [1.0_rk, 1.0_rk], "upright")
   call test_piecewise_linear([-1.0_rk, 1.0_rk], [0.0_rk, 0.0_rk], "diagonal")
   call test_whole_body()
   call checks%finish()

contains

   !> A right triangle of area 1/2 and a half-plane, a band and a corner over it.
   subroutine test_shares()
      real(rk), parameter :: cell(2, 3) = reshape([0, 0, 1, 0, 0, 1]*1.0_rk, [2, 3])
      real(rk) :: line(2, 2), share

      ! x > 1/4: a triangle with legs of 3/4.
      call share_of_cell(cell, box(0.25_rk, 9.0_rk, -9.0_rk, 9.0_rk), share, line)
      call checks%is_close(share, 0.5625_rk, tiny_error, "right of a line")
      call checks%is_close(line(1, 1), 0.25_rk, tiny_error, "its place")
      call checks%is_close(line(1, 2) - line(1, 1), 0.0_rk, tiny_error, "upright")
      call checks%is_true(line(2, 2) < line(2, 1), "the region on its left")
      call share_of_cell(cell, box(-9.0_rk, 0.25_rk, -9.0_rk, 9.0_rk), share, line)
      call checks%is_close(share, 0.4375_rk, tiny_error, "left of it")
      call checks%is_true(line(2, 2) > line(2, 1), "the region on its left")
      ! A band across: both of its sides count alike.
      call share_of_cell(cell, box(-9.0_rk, 9.0_rk, 0.25_rk, 0.5_rk), share, line)
      call checks%is_close(share, 0.5625_rk - 0.25_rk, tiny_error, "band")
      call checks%is_close(line(2, 2) - line(2, 1), 0.0_rk, tiny_error, "along the band")
      call share_of_cell(cell, box(-9.0_rk, 9.0_rk, -9.0_rk, 9.0_rk), share, line)
      call checks%is_close(share, 1.0_rk, 0.0_rk, "all of it")
      call share_of_cell(cell, box(2.0_rk, 9.0_rk, -9.0_rk, 9.0_rk), share, line)
      call checks%is_close(share, 0.0_rk, 0.0_rk, "nothing")
      call share_of_cell(cell, box(0.0_rk, 9.0_rk, 0.0_rk, 9.0_rk), share, line)
      call checks%is_close(share, 1.0_rk, tiny_error, "along its edges")
      call share_of_cell(cell, box(-9.0_rk, 0.0_rk, 0.0_rk, 9.0_rk), share, line)
      call checks%is_close(share, 0.0_rk, tiny_error, "along its edges, outside")
   end subroutine test_shares

   !> Means along and across, and permeability and resistivity that stay each other's inverse.
   subroutine test_layers()
      real(rk), parameter :: share = 0.3_rk
      real(rk), parameter :: isotropic(3, 2) = reshape([5, 5, 0, 1, 1, 0]*1.0_rk, [3, 2])
      real(rk), parameter :: turned(3, 2) = reshape([3, 2, 1, 1, 4, -1]*1.0_rk, [3, 2])
      real(rk) :: k(3), r(3, 3), inverse(2, 2), along(2), normal(2), length

      k = layered(isotropic(:, 1), isotropic(:, 2), share, [0.0_rk, 1.0_rk])
      call checks%is_close(k(1), share*5.0_rk + 1.0_rk - share, tiny_error, "along")
      call checks%is_close(k(2), 1.0_rk/(share/5.0_rk + 1.0_rk - share), tiny_error, "across")
      call checks%is_close(k(3), 0.0_rk, tiny_error, "nothing between")
      length = hypot(2.0_rk, 3.0_rk)
      along = [2.0_rk, 3.0_rk]/length
      normal = [-3.0_rk, 2.0_rk]/length
      k = layered(turned(:, 1), turned(:, 2), share, normal)
      inverse = resistivity_of(turned(:, 1), 1.0_rk)
      r(:, 1) = [inverse(1, 1), inverse(2, 2), inverse(1, 2)]
      inverse = resistivity_of(turned(:, 2), 1.0_rk)
      r(:, 2) = [inverse(1, 1), inverse(2, 2), inverse(1, 2)]
      r(:, 3) = layered(r(:, 1), r(:, 2), share, along)
      inverse = resistivity_of(k, 1.0_rk)
      call checks%is_close(r(1, 3), inverse(1, 1), tiny_error, "inverse, xx")
      call checks%is_close(r(2, 3), inverse(2, 2), tiny_error, "inverse, yy")
      call checks%is_close(r(3, 3), inverse(1, 2), tiny_error, "inverse, xy")
   end subroutine test_layers

   !> Layers at an angle of 30 degrees that conduct 1000 times better along than across stay as they
   !! are, of a ratio of 4e4 25 is left, of 1e6 and more nothing. What they resist across stays.
   subroutine test_bearable()
      real(rk), parameter :: across = 2.0e-18_rk, viscosity = 1.0e-3_rk
      real(rk), parameter :: direction(2) = [0.5_rk*sqrt(3.0_rk), 0.5_rk]
      real(rk), parameter :: ratio(4) = [1.0e3_rk, 4.0e4_rk, 1.0e6_rk, 1.0e12_rk]
      real(rk), parameter :: left(4) = [1.0e3_rk, 25.0_rk, 1.0_rk, 1.0_rk]
      real(rk), parameter :: nearly = 1.0_rk - 1.0e-9_rk
      type(conduction_t) :: found, wanted
      integer :: k

      do k = 1, size(ratio)
         found = bearable(conduction_along(direction, nearly*ratio(k)*across, across, viscosity), &
                          viscosity)
         wanted = conduction_along(direction, left(k)*across, across, viscosity)
         call checks%is_close(maxval(abs(found%permeability - wanted%permeability)), 0.0_rk, &
                              1.0e-8_rk*left(k)*across, "no more along than is borne")
         call checks%is_close(maxval(abs(found%resistivity - wanted%resistivity)), 0.0_rk, &
                              1.0e-8_rk*viscosity/across, "as much across as before")
      end do
   end subroutine test_bearable

   pure function conduction_along(direction, along, across, viscosity) result(found)
      real(rk), intent(in) :: direction(2)  !< unit vector
      real(rk), intent(in) :: along, across  !< [m2]
      real(rk), intent(in) :: viscosity  !< [Pa s]
      type(conduction_t) :: found

      associate (c => direction(1), s => direction(2))
         found%permeability = along*[c**2, s**2, c*s] + across*[s**2, c**2, -c*s]
         found%resistivity = viscosity*([c**2, s**2, c*s]/along + [s**2, c**2, -c*s]/across)
      end associate
   end function conduction_along

   !> A sheet that seals, thinner than the cells that it goes through: they resist across it as the
   !! layers do that they hold, whatever the contrast.
   subroutine test_sealing_sheet()
      real(rk), parameter :: sheet(4) = [0.7_rk, 0.71_rk, -1.0_rk, 3.0_rk]
      real(rk), parameter :: contrast(3) = [1.0e2_rk, 1.0e6_rk, 1.0e12_rk]
      type(rock_t) :: rock
      real(rk) :: layering, line(2, 2), share, worst
      integer(ik) :: c
      integer :: k

      mesh = boxes(4_ik)
      scene = body_with(1)
      do k = 1, size(contrast)
         scene%regions(1) = box_region(sheet(1), sheet(2), sheet(3), sheet(4), &
                                       scene%material%permeability_xx/contrast(k))
         rock = new_rock(scene%material, scene%fluid)
         call place_regions(mesh, scene%regions, scene%domain, scene%fluid, rock)
         worst = 0.0_rk
         layering = 0.0_rk
         do c = 1, mesh%n_cells
            call share_of_cell(mesh%xy(:, mesh%cell_nodes(:, c)), &
                               box(sheet(1), sheet(2), sheet(3), sheet(4)), share, line)
            associate (layers => scene%fluid%viscosity/scene%material%permeability_xx &
                       *(1.0_rk - share + share*contrast(k)))
               worst = max(worst, abs(rock%resistivity(1, 1, c)/layers - 1.0_rk))
            end associate
            layering = max(layering, (1.0_rk - share + share*contrast(k)) &
                           *(1.0_rk - share + share/contrast(k)))
         end do
         call checks%is_close(rock%most_layered/layering, 1.0_rk, 1.0e-9_rk, &
                              "how much better it conducts along")
         call checks%is_close(worst, 0.0_rk, 1.0e-9_rk, "resistance across a thin sheet")
      end do
   end subroutine test_sealing_sheet

   !> Flow along a strip between sealing rock, from a pressure of 1 MPa to one of 0, in a mesh that
   !! knows nothing of the strip: all pressures lie between the two.
   subroutine test_bounds()
      real(rk), parameter :: contrast(3) = [1.0e6_rk, 1.0e9_rk, 1.0e12_rk]
      real(rk), parameter :: given = 1.0e6_rk  ! [Pa]
      real(rk), parameter :: slack = 0.01_rk  ! of the range: triangles are not all acute
      real(rk) :: none(2, 2, 0)
      type(coarse_model_t) :: model
      type(state_t) :: state
      integer :: k, step

      call mesh_square(checks, straight_network(none), 0.2_rk, 0.2_rk, mesh)
      do k = 1, size(contrast)
         scene = body_with(1)
         call set_permeability(scene, 1.0e-12_rk/contrast(k))
         scene%regions(1) = box_region(-1.0_rk, 3.0_rk, 0.0_rk, 1.0_rk, 1.0e-12_rk)
         scene%regions(1)%y = [0.57_rk, 0.97_rk, 1.61_rk, 1.21_rk]  ! askew to the mesh
         scene%sides%displacement_given(1) = .true.
         scene%sides%displacement_given(2) = .true.
         scene%sides(:2)%pressure_given = .true.
         scene%sides(1)%pressure = given
         model%cells = uniform_cells(mesh, contact_law_t(), 1.0e-3_rk)
         call model%set_mesh(mesh, scene, timers, error)
         call checks%no_error(error, "a strip")
         call new_state(mesh, model%cells, scene%initial, model, state)
         do step = 1, 3
            call model%advance(mesh, 1.0e22_rk, state, timers, report, error)
            call checks%no_error(error, "flow along a strip")
         end do
         associate (pressure => state%unknowns(3, :mesh%n_cells)/given)
            call checks%is_true(minval(pressure) > -slack, "no pressure below the lowest")
            call checks%is_true(maxval(pressure) < 1.0_rk + slack, "none above the highest")
            print "(es8.1,2f12.7)", contrast(k), minval(pressure), maxval(pressure)
         end associate
      end do
   end subroutine test_bounds

   !> Of regions that overlap the last one counts; cells that they leave keep the scene's rock.
   subroutine test_order()
      type(rock_t) :: rock
      integer(ik) :: c
      real(rk) :: expected

      mesh = boxes(4_ik)
      scene = body_with(2)
      scene%regions(1) = box_region(-1.0_rk, 1.0_rk, -1.0_rk, 3.0_rk, 2.0e-15_rk)
      scene%regions(2) = box_region(-1.0_rk, 3.0_rk, -1.0_rk, 0.5_rk, 3.0e-15_rk)
      rock = new_rock(scene%material, scene%fluid)
      call place_regions(mesh, scene%regions, scene%domain, scene%fluid, rock)
      call checks%is_true(size(rock%permeability, 2) == mesh%n_cells, "of each cell")
      do c = 1, mesh%n_cells
         associate (xy => cell_centre(mesh, c))
            expected = scene%material%permeability_xx
            if (xy(1) < 1.0_rk) expected = 2.0e-15_rk
            if (xy(2) < 0.5_rk) expected = 3.0e-15_rk
         end associate
         call checks%is_close(rock%permeability(1, c), expected, 1.0e-24_rk, "the last region")
         call checks%is_close(rock%resistivity(2, 2, c)*expected, scene%fluid%viscosity, &
                              1.0e-12_rk*scene%fluid%viscosity, "its resistivity")
      end do
   end subroutine test_order

   !> Two regions that share an outline, and fill the body, leave nothing of the rock around them.
   subroutine test_neighbours()
      type(rock_t) :: rock
      real(rk) :: content
      integer(ik) :: c

      mesh = boxes(5_ik)
      scene = body_with(2)
      call set_permeability(scene, 1.0e-25_rk)
      scene%regions(1) = box_region(-1.0_rk, 1.07_rk, -1.0_rk, 3.0_rk, 2.0e-15_rk)
      scene%regions(2) = box_region(1.07_rk, 3.0_rk, -1.0_rk, 3.0_rk, 1.0e-15_rk)
      rock = new_rock(scene%material, scene%fluid)
      call place_regions(mesh, scene%regions, scene%domain, scene%fluid, rock)
      ! Along the layers the mean over the body is that of the areas, in every direction of cuts.
      content = sum(rock%permeability(2, :)*[(cell_area(mesh, c), c=1, mesh%n_cells)])
      call checks%is_close(content, 2.0_rk*(1.07_rk*2.0e-15_rk + 0.93_rk*1.0e-15_rk), 1.0e-25_rk, &
                           "mean along the outline")
      call checks%is_true(all(rock%permeability(1, :) >= 1.0e-15_rk*(1.0_rk - 1.0e-12_rk)), &
                          "nothing between neighbours")
   end subroutine test_neighbours

   !> Two rocks with full tensors, a body 2 m wide cut along edges of the mesh. A pressure that is
   !! linear in either, equal along the cut and with the same flux across it, is reproduced: no cell
   !! gains fluid, and gradients are exact. Cells at the closed sides are left out.
   subroutine test_piecewise_linear(normal, through, name)
      real(rk), intent(in) :: normal(2)  !< of the cut
      real(rk), intent(in) :: through(2)  !< a point of the cut [m]
      character(len=*), intent(in) :: name
      real(rk), parameter :: first(3) = [3.0e-14_rk, 1.0e-14_rk, 1.2e-14_rk]
      real(rk), parameter :: second(3) = [2.0e-16_rk, 7.0e-16_rk, -3.0e-16_rk]
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), allocatable :: around(:), outflow(:), pressure(:)
      real(rk) :: slope(2, 2), gradient(2), along(2), worst, flux
      integer(ik) :: c, k, side

      mesh = boxes(8_ik)
      scene = body_with(1)
      scene%material%permeability_xx = first(1)
      scene%material%permeability_yy = first(2)
      scene%material%permeability_xy = first(3)
      along = [normal(2), -normal(1)]
      scene%regions(1)%shape = "half_plane"
      scene%regions(1)%x = through(1) + [0.0_rk, along(1)]
      scene%regions(1)%y = through(2) + [0.0_rk, along(2)]
      scene%regions(1)%material%permeability_xx = second(1)
      scene%regions(1)%material%permeability_yy = second(2)
      scene%regions(1)%material%permeability_xy = second(3)
      slope(:, 1) = [0.7e6_rk, -0.4e6_rk]
      ! The second gradient differs by a multiple of the normal.
      flux = dot_product(normal, applied(first, slope(:, 1)))
     slope(:, 2) = slope(:, 1) + normal*(flux - dot_product(normal, applied(second, slope(:, 1)))) &
                    /dot_product(normal, applied(second, normal))
      rock = new_rock(scene%material, scene%fluid)
      call place_regions(mesh, scene%regions, scene%domain, scene%fluid, rock)
      call discretize(mesh, rock, scene%sides, regions, matrix, error)
      call checks%no_error(error, name)
      allocate (pressure(regions%n_blocks), outflow(mesh%n_cells))
      do c = 1, mesh%n_cells
         associate (from => cell_centre(mesh, c) - through)
            side = merge(2, 1, dot_product(normal, from) > 0.0_rk)
            pressure(c) = 5.0e6_rk + dot_product(slope(:, side), from)
         end associate
      end do
      call cell_outflow(mesh, regions, regions%flux, pressure, outflow)
      worst = 0.0_rk
      do c = 1, mesh%n_cells
         if (is_outer(mesh, c)) cycle
         worst = max(worst, abs(outflow(c)))
         side = merge(2, 1, dot_product(normal, cell_centre(mesh, c) - through) > 0.0_rk)
         do k = 1, 3
            allocate (around(regions%flow_faces%length(regions%regions_of_block(k, c))))
            call region_fluxes(regions, regions%flux, pressure, regions%regions_of_block(k, c), &
                               around)
            call corner_gradient(mesh, rock%resistivity, regions, around, c, k, gradient)
            deallocate (around)
           call checks%is_close(norm2(gradient - slope(:, side))/norm2(slope), 0.0_rk, 1.0e-10_rk, &
                                 name//": gradient")
         end do
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-11_rk*abs(flux)/scene%fluid%viscosity, &
                           name//": balance")
   end subroutine test_piecewise_linear

   pure logical function is_outer(mesh, cell)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell

      associate (corners => mesh%xy(:, mesh%cell_nodes(:, cell)))
         is_outer = any(corners < 1.0e-9_rk .or. corners > 2.0_rk - 1.0e-9_rk)
      end associate
   end function is_outer

   !> A leaking fracture in a body that one region fills is one in a body of that rock: storage,
   !! stencils and what the tip cells need.
   subroutine test_whole_body()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: pressure(2)
      integer :: k

      call mesh_square(checks, straight_network(reshape([0.9_rk, 0.9_rk, 1.1_rk, 1.1_rk], &
                                                        [2, 2, 1])), 0.05_rk, 0.3_rk, mesh)
      do k = 1, 2
         scene = body_with(1)
         call set_permeability(scene, merge(1.0e-15_rk, 1.0e-19_rk, k == 1))
         scene%regions(1) = box_region(-1.0_rk, 3.0_rk, -1.0_rk, 3.0_rk, 1.0e-15_rk)
         if (k == 1) deallocate (scene%regions)
         call load_sides(scene, [-1.0e6_rk, -1.0e6_rk, 0.0_rk])
         call hold(scene)
         scene%sides%pressure_given = .true.
         model%cells = uniform_cells(mesh, contact_law_t(), 1.0e-3_rk)
         model%cells%injection(2) = 1.0e-8_rk
         call model%set_mesh(mesh, scene, timers, error)
         call checks%no_error(error, "discretization")
         call new_state(mesh, model%cells, scene%initial, model, state)
         call advance(checks, model, mesh, 100.0_rk, state, report, "a leaking fracture")
         pressure(k) = state%pressure(1)
      end do
      call checks%is_close(pressure(2)/pressure(1), 1.0_rk, 1.0e-9_rk, "a region fills the body")
   end subroutine test_whole_body

   function body_with(n) result(scene)
      integer, intent(in) :: n  !< regions
      type(scene_t) :: scene

      scene = porous_body()
      scene%domain%x_max = 2.0_rk
      scene%domain%y_max = 2.0_rk
      allocate (scene%regions(n))
      scene%regions%material = scene%material
   end function body_with

   pure function box_region(x_min, x_max, y_min, y_max, permeability) result(region)
      real(rk), intent(in) :: x_min, x_max, y_min, y_max, permeability
      type(region_t) :: region
      type(scene_t) :: scene
      real(rk) :: corners(2, 4)

      scene = porous_body()
      region%material = scene%material
      corners = box(x_min, x_max, y_min, y_max)
      region%x = corners(1, :)
      region%y = corners(2, :)
      region%material%permeability_xx = permeability
      region%material%permeability_yy = permeability
   end function box_region

   pure function box(x_min, x_max, y_min, y_max) result(corners)
      real(rk), intent(in) :: x_min, x_max, y_min, y_max
      real(rk) :: corners(2, 4)

      corners(1, :) = [x_min, x_max, x_max, x_min]
      corners(2, :) = [y_min, y_min, y_max, y_max]
   end function box

   pure function applied(tensor, vector) result(image)
      real(rk), intent(in) :: tensor(3), vector(2)
      real(rk) :: image(2)

      image = [tensor(1)*vector(1) + tensor(3)*vector(2), tensor(3)*vector(1) + tensor(2)*vector(2)]
   end function applied

end program test_coarse_permeability
